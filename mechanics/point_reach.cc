#include "mechanics/point_reach.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

namespace koboshi::mechanics {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMost = static_cast<int>(PointChain::kMaxHinges);
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMost>;

constexpr int kMaxReachSteps = 100;
constexpr double kReached_m = 2e-6;
constexpr double kDamping_m = 2e-3;
constexpr double kMaxStep_rad = 0.4;

// Returns the point's position, and with a matrix the velocity of the point at unit speed of each hinge.
Vector3d place(const PointChain& chain, const Positions& q, Jacobian* J = nullptr) {
  std::array<Vector3d, PointChain::kMaxHinges> anchors;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < chain.hinges.size(); ++i) {
    const PointChain::Hinge& hinge = chain.hinges[i];
    X.translate(hinge.anchor_P);
    anchors[i] = X.translation();
    if (J != nullptr) J->col(static_cast<Index>(i)) = X.linear() * hinge.axis_P;
    X.rotate(Eigen::AngleAxisd(q[static_cast<Index>(i)], hinge.axis_P));
  }
  const Vector3d tip = X * chain.tip;
  if (J != nullptr)
    for (std::size_t i = 0; i < chain.hinges.size(); ++i) {
      const auto column = static_cast<Index>(i);
      J->col(column) = Vector3d(J->col(column)).cross(tip - anchors[i]);
    }
  return tip;
}

}  // namespace

Vector3d PointChain::tip_at(std::span<const double> positions_rad) const {
  return place(*this, Eigen::Map<const Eigen::VectorXd>(positions_rad.data(),
                                                        static_cast<Index>(positions_rad.size())));
}

double reach_point(const PointChain& chain, const Vector3d& target, std::span<double> positions_rad) {
  const auto size = static_cast<Index>(chain.hinges.size());
  Eigen::Map<Eigen::VectorXd> given(positions_rad.data(), size);
  Positions q = given;
  Positions best = q;
  double best_m = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxReachSteps; ++step) {
    Jacobian J(3, size);
    const Vector3d error = target - place(chain, q, &J);
    if (error.norm() < best_m) {
      best_m = error.norm();
      best = q;
    }
    if (best_m < kReached_m) break;
    for (Index pass = 0; pass < size; ++pass) {
      const double damping = std::min(kDamping_m, error.norm());
      const Matrix3d damped = J * J.transpose() + damping * damping * Matrix3d::Identity();
      Positions change = Positions::Zero(size);
      change.noalias() = J.transpose() * damped.ldlt().solve(error);
      const double longest = change.cwiseAbs().maxCoeff();
      if (longest > kMaxStep_rad) change *= kMaxStep_rad / longest;
      bool blocked = false;
      for (Index i = 0; i < size; ++i) {
        const PointChain::Hinge& hinge = chain.hinges[static_cast<std::size_t>(i)];
        const bool outward =
            (q[i] >= hinge.upper_rad && change[i] > 0.0) || (q[i] <= hinge.lower_rad && change[i] < 0.0);
        if (outward && !J.col(i).isZero()) {
          J.col(i).setZero();
          blocked = true;
        }
      }
      if (blocked) continue;
      for (Index i = 0; i < size; ++i) {
        const PointChain::Hinge& hinge = chain.hinges[static_cast<std::size_t>(i)];
        q[i] = std::clamp(q[i] + change[i], hinge.lower_rad, hinge.upper_rad);
      }
      break;
    }
  }
  given = best;
  return best_m;
}

}  // namespace koboshi::mechanics
