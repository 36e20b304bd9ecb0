#pragma once

#include <Eigen/Core>

namespace koboshi::simulation {

// The linear inverted pendulum of the paper's section 3.1, sagittal (x) and lateral (y) alike: a point mass
// at constant height over a ZMP in the plane.

struct PendulumState {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();
};

// The ZMP on its way along a straight line, at constant speed.
struct ZmpPiece {
  double duration_s = 0.0;
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();

  Eigen::Vector2d at(double time_s) const { return from_m + (to_m - from_m) * (time_s / duration_s); }
};

class Pendulum {
 public:
  // `height_m` is positive.
  explicit Pendulum(double height_m);

  // T_c = sqrt(z / g).
  double time_constant_s() const { return time_constant_s_; }
  // Where the mass is after `time_s`: the paper's equation 3, about a ZMP that moves. A ZMP on a straight
  // line has no acceleration, so that the distance from it obeys the same equation as that from a resting
  // one.
  PendulumState advance(const PendulumState& state, const ZmpPiece& zmp, double time_s) const;

 private:
  double time_constant_s_;
};

}  // namespace koboshi::simulation
