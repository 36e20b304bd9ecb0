#include "studio/document/bounded_least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <vector>

namespace koboshi::studio {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Weights of the hard residuals. A step along a curved constraint leaves it, so that a heavy one alone would
// allow short steps only. At the last one, a pull of 0.1 m leaves 0.1 m / kWeights^2 = 2e-8 m.
constexpr std::array kWeights{20.0, 200.0, 2000.0};
constexpr int kMaxSteps = 40;  // per weight; most end after 5 to 15
constexpr double kConverged_rad = 1e-6;
constexpr double kDifference_rad = 1e-6;  // of the central differences
// A longer soft residual pulls as one of this length: the least squares of a target far beyond the reach
// would overshoot by the ratio of its distance to the length of the limb.
constexpr double kMaxPull_m = 0.1;
constexpr double kFirstDamping = 1e-4;  // m^2/rad^2
constexpr double kLeastDamping = 1e-9;
constexpr double kMostDamping = 1e3;

struct Linear {
  MatrixXd hard;
  MatrixXd soft;
};

double cost(const Residuals& r, double weight) {
  return weight * weight * r.hard.squaredNorm() + r.soft.squaredNorm();
}

Linear differentiate(const ResidualFunction& residuals, const VectorXd& q, const Residuals& now) {
  Linear J{MatrixXd(now.hard.size(), q.size()), MatrixXd(now.soft.size(), q.size())};
  for (Index i = 0; i < q.size(); ++i) {
    VectorXd moved = q;
    moved[i] = q[i] + kDifference_rad;
    const Residuals after = residuals(moved);
    moved[i] = q[i] - kDifference_rad;
    const Residuals before = residuals(moved);
    J.hard.col(i) = (after.hard - before.hard) / (2.0 * kDifference_rad);
    J.soft.col(i) = (after.soft - before.soft) / (2.0 * kDifference_rad);
  }
  return J;
}

// Descends with one weight; `q` and its residuals are replaced.
void descend(const ResidualFunction& residuals, const VariableBounds& bounds, double weight, VectorXd& q,
             Residuals& now) {
  double damping = kFirstDamping;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Linear J = differentiate(residuals, q, now);
    const double pull = std::min(1.0, kMaxPull_m / std::max(now.soft.norm(), 1e-12));
    const double weight2 = weight * weight;
    const MatrixXd H = weight2 * J.hard.transpose() * J.hard + J.soft.transpose() * J.soft;
    const VectorXd g = weight2 * J.hard.transpose() * now.hard + pull * J.soft.transpose() * now.soft;
    const VariableBounds left{bounds.lower - q, bounds.upper - q};
    bool improved = false;
    double length_rad = 0.0;
    while (!improved && damping < kMostDamping) {
      const VectorXd d = minimise_quadratic(H + damping * MatrixXd::Identity(q.size(), q.size()), g, left);
      length_rad = d.lpNorm<Eigen::Infinity>();
      const VectorXd next = (q + d).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
      Residuals after = residuals(next);
      improved = cost(after, weight) < cost(now, weight);
      if (improved) {
        q = next;
        now = std::move(after);
      } else if (length_rad < kConverged_rad) {
        return;
      }
      damping = improved ? std::max(0.2 * damping, kLeastDamping) : 5.0 * damping;
    }
    if (!improved || length_rad < kConverged_rad) return;
  }
}

}  // namespace

VectorXd minimise_quadratic(const MatrixXd& H, const VectorXd& g, const VariableBounds& bounds) {
  const Index n = g.size();
  VectorXd d = VectorXd::Zero(n);
  std::vector<bool> is_fixed(static_cast<std::size_t>(n), false);
  const auto fixed = [&](Index i) { return is_fixed[static_cast<std::size_t>(i)]; };
  for (Index pass = 0; pass < 6 * n; ++pass) {
    const VectorXd gradient = H * d + g;
    std::vector<Index> free;
    for (Index i = 0; i < n; ++i)
      if (!fixed(i)) free.push_back(i);
    VectorXd p = VectorXd::Zero(n);
    if (!free.empty()) {
      const MatrixXd H_free = H(free, free);
      const VectorXd g_free = gradient(free);
      p(free) = -H_free.llt().solve(g_free);
    }
    double share = 1.0;
    Index blocking = -1;
    for (const Index i : free) {
      const double room = p[i] > 0.0 ? bounds.upper[i] - d[i] : bounds.lower[i] - d[i];
      if (p[i] == 0.0 || room / p[i] >= share) continue;
      share = std::max(0.0, room / p[i]);
      blocking = i;
    }
    d += share * p;
    if (blocking >= 0) {
      d[blocking] = p[blocking] > 0.0 ? bounds.upper[blocking] : bounds.lower[blocking];
      is_fixed[static_cast<std::size_t>(blocking)] = true;
      continue;
    }
    // At the minimum for these bounds: a bound that holds back a descent is given up.
    const VectorXd slope = H * d + g;
    Index worst = -1;
    double worst_slope = 1e-12;
    for (Index i = 0; i < n; ++i) {
      if (!fixed(i) || bounds.lower[i] == bounds.upper[i]) continue;
      const double descent = d[i] <= bounds.lower[i] ? -slope[i] : slope[i];
      if (descent <= worst_slope) continue;
      worst_slope = descent;
      worst = i;
    }
    if (worst < 0) break;
    is_fixed[static_cast<std::size_t>(worst)] = false;
  }
  return d;
}

VectorXd minimise_residuals(const ResidualFunction& residuals, const VariableBounds& bounds,
                            const VectorXd& from) {
  VectorXd q = from;
  Residuals now = residuals(q);
  for (const double weight : kWeights) {
    descend(residuals, bounds, weight, q, now);
    if (now.hard.size() == 0) break;
  }
  return q;
}

}  // namespace koboshi::studio
