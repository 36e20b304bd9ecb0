#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

#include "mechanics/box_lcp.h"

namespace koboshi::mechanics {

// Residuals in m: those that have to vanish, and those whose sum of squares is to be small.
struct Residuals {
  Eigen::VectorXd hard;
  Eigen::VectorXd soft;
};

// Limits of the variables; lower <= upper.
struct VariableBounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

// Finds a local minimum of |soft|^2 with hard = 0 within bounds: damped least squares (Levenberg 1944,
// Marquardt 1963) with a growing weight of the hard residuals, each step of which is a quadratic programme
// with bounds (BoxLcp). Deterministic. Allocates nothing after construction.
class BoundedLeastSquares {
 public:
  // Writes the residuals at these variables, in rad, into vectors of the right size.
  using Function = std::function<void(const Eigen::VectorXd&, Residuals&)>;

  BoundedLeastSquares(std::size_t variables, std::size_t hard_residuals, std::size_t soft_residuals);

  // Replaces `q`, which lies within the bounds, by the minimum to which it leads. Hard residuals are then
  // below 1e-5 m where the bounds allow it.
  void minimise(const Function& function, const VariableBounds& bounds, Eigen::VectorXd& q);

 private:
  // Descends with one weight of the hard residuals from `q`, at which they are now_.
  void descend(const Function& function, const VariableBounds& bounds, double weight, Eigen::VectorXd& q);
  void differentiate(const Function& function, const Eigen::VectorXd& q);
  // Computes the step within the bounds for this damping of the linear problem. Returns false if rounding
  // prevents it, which more damping mends.
  bool find_step(const VariableBounds& bounds, const Eigen::VectorXd& q, double damping);

  Residuals now_, before_, after_;
  Eigen::MatrixXd hard_jacobian_, soft_jacobian_;
  Eigen::MatrixXd curvature_;  // of the linear problem
  Eigen::VectorXd slope_;
  Eigen::VectorXd step_, moved_;
  BoxLcp programme_;
};

}  // namespace koboshi::mechanics
