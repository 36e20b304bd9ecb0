#pragma once

#include <Eigen/Core>

#include "sim_board/description/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Quantities of the whole robot that no sensor measures, from the poses and velocities of its links.

struct CentreOfMass {
  Eigen::Vector3d p_WCom_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();  // m/s
};

CentreOfMass centre_of_mass(const RobotDescription& robot, const World& world);

// Pose of a link at the beginning of the last step, for which the solver computed contact points, contact
// forces and joint wrenches. The engines integrate the pose with the velocity at the end of the step, so the
// step can be reversed.
Eigen::Isometry3d pose_before_step(const RobotDescription& robot, const World& world, int link);

// Kinetic energy of a link or of all links (without rotors), and potential energy relative to the world's
// origin.
double link_energy_J(const RobotDescription& robot, const World& world, int link,
                     const Eigen::Vector3d& gravity_W_m_per_s2);
double energy_J(const RobotDescription& robot, const World& world, const Eigen::Vector3d& gravity_W_m_per_s2);

}  // namespace koboshi::sim_board
