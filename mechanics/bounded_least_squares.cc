#include "mechanics/bounded_least_squares.h"

#include <algorithm>
#include <array>
#include <utility>

namespace koboshi::mechanics {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Weights of the hard residuals. A step along a curved constraint leaves it, so that a heavy one alone would
// allow short steps only. At the last one, a pull of 0.1 m leaves 0.1 m / kWeights^2 = 2e-8 m.
constexpr std::array kWeights{20.0, 200.0, 2000.0};
constexpr int kMaxDescents = 40;  // per weight; most end after 5 to 15
constexpr double kConverged_rad = 1e-6;
constexpr double kDifference_rad = 1e-6;  // of the central differences
// A longer soft residual pulls as one of this length: the least squares of a target far beyond the reach
// would overshoot by the ratio of its distance to the length of the limb.
constexpr double kMaxPull_m = 0.1;
constexpr double kFirstDamping = 1e-4;  // m^2/rad^2
constexpr double kMinDamping = 1e-9;
constexpr double kMaxDamping = 1e3;

double cost(const Residuals& r, double weight) {
  return weight * weight * r.hard.squaredNorm() + r.soft.squaredNorm();
}

Index index(std::size_t size) { return static_cast<Index>(size); }

}  // namespace

BoundedLeastSquares::BoundedLeastSquares(std::size_t variables, std::size_t hard_residuals,
                                         std::size_t soft_residuals)
    : now_{VectorXd(index(hard_residuals)), VectorXd(index(soft_residuals))},
      before_(now_),
      after_(now_),
      hard_jacobian_(index(hard_residuals), index(variables)),
      soft_jacobian_(index(soft_residuals), index(variables)),
      curvature_(index(variables), index(variables)),
      slope_(index(variables)),
      step_(index(variables)),
      moved_(index(variables)),
      programme_(variables) {}

void BoundedLeastSquares::minimise(const Function& function, const VariableBounds& bounds, VectorXd& q) {
  function(q, now_);
  for (const double weight : kWeights) {
    descend(function, bounds, weight, q);
    if (now_.hard.size() == 0) break;
  }
}

void BoundedLeastSquares::differentiate(const Function& function, const VectorXd& q) {
  moved_ = q;
  for (Index i = 0; i < q.size(); ++i) {
    moved_[i] = q[i] + kDifference_rad;
    function(moved_, after_);
    moved_[i] = q[i] - kDifference_rad;
    function(moved_, before_);
    moved_[i] = q[i];
    hard_jacobian_.col(i) = (after_.hard - before_.hard) / (2.0 * kDifference_rad);
    soft_jacobian_.col(i) = (after_.soft - before_.soft) / (2.0 * kDifference_rad);
  }
}

bool BoundedLeastSquares::find_step(const VariableBounds& bounds, const VectorXd& q, double damping) {
  programme_.resize(static_cast<std::size_t>(q.size()));
  Eigen::Map<Eigen::MatrixXd> A(programme_.A().data(), q.size(), q.size());  // symmetric
  A = curvature_;
  A.diagonal().array() += damping;
  Eigen::Map<VectorXd>(programme_.b().data(), q.size()) = -slope_;
  for (std::size_t i = 0; i < programme_.bounds().size(); ++i) {
    const Index variable = index(i);
    programme_.bounds()[i] = {bounds.lower[variable] - q[variable], bounds.upper[variable] - q[variable]};
    programme_.sides()[i] = BoxLcp::Side::kFree;
    programme_.x()[i] = 0.0;
  }
  if (!programme_.solve()) return false;
  step_ = Eigen::Map<const VectorXd>(programme_.x().data(), q.size());
  return true;
}

void BoundedLeastSquares::descend(const Function& function, const VariableBounds& bounds, double weight,
                                  VectorXd& q) {
  double damping = kFirstDamping;
  const double weight2 = weight * weight;
  for (int step = 0; step < kMaxDescents; ++step) {
    differentiate(function, q);
    const double pull = std::min(1.0, kMaxPull_m / std::max(now_.soft.norm(), 1e-12));
    curvature_.noalias() = soft_jacobian_.transpose() * soft_jacobian_;
    slope_.noalias() = pull * soft_jacobian_.transpose() * now_.soft;
    if (now_.hard.size() > 0) {
      curvature_.noalias() += weight2 * hard_jacobian_.transpose() * hard_jacobian_;
      slope_.noalias() += weight2 * hard_jacobian_.transpose() * now_.hard;
    }
    bool improved = false;
    double length_rad = 0.0;
    while (!improved && damping < kMaxDamping) {
      if (!find_step(bounds, q, damping)) {
        damping *= 5.0;
        continue;
      }
      length_rad = step_.lpNorm<Eigen::Infinity>();
      moved_ = (q + step_).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
      function(moved_, after_);
      improved = cost(after_, weight) < cost(now_, weight);
      if (improved) {
        q = moved_;
        std::swap(now_, after_);
      } else if (length_rad < kConverged_rad) {
        return;
      }
      damping = improved ? std::max(0.2 * damping, kMinDamping) : 5.0 * damping;
    }
    if (!improved || length_rad < kConverged_rad) return;
  }
}

}  // namespace koboshi::mechanics
