#pragma once

#include <Eigen/Core>

#include "sim_board/robot/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// What no sensor shows: quantities of the whole robot, from the poses and velocities of its links.

struct CentreOfMass {
  Eigen::Vector3d p_WCom_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();  // m/s
};

CentreOfMass centre_of_mass(const RobotDescription& robot, const World& world);

// The pose of a link when the last step began: the solver found contact points, contact forces and joint
// wrenches for it. The engines move a body with the velocity at the end of a step, so that it can be gone
// back.
Eigen::Isometry3d pose_before_step(const RobotDescription& robot, const World& world, int link);

// Kinetic energy of a link, or of all (rotors not counted), and potential energy relative to the world's
// origin.
double link_energy_J(const RobotDescription& robot, const World& world, int link,
                     const Eigen::Vector3d& gravity_W_m_per_s2);
double energy_J(const RobotDescription& robot, const World& world, const Eigen::Vector3d& gravity_W_m_per_s2);

}  // namespace koboshi::sim
