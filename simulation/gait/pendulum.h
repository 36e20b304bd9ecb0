#pragma once

#include <Eigen/Core>

namespace koboshi::simulation {

// The linear inverted pendulum of the paper's section 3.1, for the sagittal (x) and lateral (y) axes: a point
// mass at constant height above a ZMP in the plane.

struct PendulumState {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();
};

// A ZMP that moves along a straight line at constant speed.
struct ZmpPiece {
  double duration_s = 0.0;
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();

  Eigen::Vector2d at(double time_s) const { return from_m + (to_m - from_m) * (time_s / duration_s); }
};

class Pendulum {
 public:
  // `height_m` must be positive.
  explicit Pendulum(double height_m);

  // T_c = sqrt(z / g).
  double time_constant_s() const { return time_constant_s_; }
  // Returns the state after `time_s`: the paper's equation 3, extended to a moving ZMP. A ZMP at constant
  // velocity has no acceleration, so the relative position obeys the same equation as with a fixed ZMP.
  PendulumState advance(const PendulumState& state, const ZmpPiece& zmp, double time_s) const;

 private:
  double time_constant_s_;
};

}  // namespace koboshi::simulation
