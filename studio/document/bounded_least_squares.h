#pragma once

#include <Eigen/Core>
#include <functional>

namespace koboshi::studio {

// Residuals of a pose in m: those that have to vanish, and those whose sum of squares is to be small.
struct Residuals {
  Eigen::VectorXd hard;
  Eigen::VectorXd soft;
};
using ResidualFunction = std::function<Residuals(const Eigen::VectorXd&)>;

// Limits of the variables; lower <= upper.
struct VariableBounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

// Finds a local minimum of |soft|^2 with hard = 0 within the bounds: damped least squares (Levenberg 1944,
// Marquardt 1963) with a growing weight of the hard residuals, each step of which is the solution of a
// quadratic programme with bounds. Returns the variables; hard residuals are then below 1e-5 m where the
// bounds allow it. `from` lies within the bounds. Deterministic.
[[nodiscard]] Eigen::VectorXd minimise_residuals(const ResidualFunction& residuals,
                                                 const VariableBounds& bounds, const Eigen::VectorXd& from);

// Returns the minimum of d' H d / 2 + g' d within the bounds, for a positive definite H, by a primal
// active-set method (Nocedal and Wright 2006, algorithm 16.3). Zero lies within the bounds.
[[nodiscard]] Eigen::VectorXd minimise_quadratic(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                                                 const VariableBounds& bounds);

}  // namespace koboshi::studio
