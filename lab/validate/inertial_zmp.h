#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim_board/description/description.h"
#include "sim_board/world/world.h"

namespace koboshi::lab {

// The ZMP on z = 0 by the motion of all links alone (Vukobratovic and Borovac, 2004):
//   x = (sum m (x (z'' + g) - z x'') - sum dL_y/dt) / sum m (z'' + g),  y alike with dL_x/dt.
// It follows from the rate of momentum about the origin. Over one step the rates are those of
// momentum and angular momentum between two observations; rotors are inside the robot and not in them.
class InertialZmp {
 public:
  // The robot must outlive it. Gravity points down.
  InertialZmp(const sim_board::RobotDescription& robot, double gravity_m_per_s2)
      : robot_(robot), gravity_m_per_s2_(gravity_m_per_s2) {}

  // Call this after each step of the world. Returns nothing the first time, and without load on the ground.
  std::optional<Eigen::Vector2d> observe(const sim_board::World& world);

 private:
  struct Momentum {
    double time_s = 0.0;
    Eigen::Vector3d first_kg_m = Eigen::Vector3d::Zero();  // sum m p
    Eigen::Vector3d linear_N_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_Nm_s = Eigen::Vector3d::Zero();  // about the world's origin
  };
  Momentum momentum_of(const sim_board::World& world) const;

  const sim_board::RobotDescription& robot_;
  double gravity_m_per_s2_;
  std::optional<Momentum> before_;
};

}  // namespace koboshi::lab
