#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "mechanics/spatial.h"

namespace koboshi::mechanics {

// Forces that a tree of hinges needs for a motion of which one link is at rest: the recursive Newton-Euler
// algorithm (Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 5.3). All vectors are in axes of
// the root link, spatial vectors about its origin. Allocates nothing after construction.
class InverseDynamics {
 public:
  explicit InverseDynamics(HingeTree tree);
  const HingeTree& tree() const { return tree_; }

  // Places the links; the functions below follow.
  void place(std::span<const double> positions_rad);
  const std::vector<Eigen::Isometry3d>& X_BLs() const { return X_BLs_; }
  const Eigen::Vector3d& com_B() const { return com_B_; }

  // Computes the forces on the links for these joint speeds and accelerations while the link `at_rest` does
  // not move, in gravity of `gravity_B_m_per_s2`. Returns their sum, which the ground supplies.
  Vector6 find_forces(std::span<const double> speeds_rad_per_s,
                      std::span<const double> accelerations_rad_per_s2, std::size_t at_rest,
                      const Eigen::Vector3d& gravity_B_m_per_s2);
  // Subtracts a force of the ground on a link from what its hinge has to supply.
  void support(std::size_t link, const Vector6& force) { forces_[link] -= force; }
  // Computes the torque of each free hinge, whose motor also moves those that follow it, and supplies what is
  // left. It is that of the motion only if the ground supports the sum of the forces. Each call consumes the
  // forces.
  void find_torques(std::span<double> torques_Nm);

 private:
  // The speed or acceleration of a hinge, given those of the free hinges.
  double rate(std::size_t hinge, std::span<const double> rates) const;
  // Adds up speeds along the tree from that of the root.
  void add_velocities(std::span<const double> speeds_rad_per_s, const Vector6& root);

  HingeTree tree_;
  std::vector<Eigen::Isometry3d> X_BLs_;
  Eigen::Vector3d com_B_ = Eigen::Vector3d::Zero();
  std::vector<Vector6> motions_;          // by hinge: velocity of the child at unit speed
  std::vector<SpatialInertia> inertias_;  // by link, as the following
  std::vector<Vector6> velocities_;
  std::vector<Vector6> accelerations_;
  std::vector<Vector6> forces_;
  std::vector<double> coupled_Nm_;  // by coupling
};

}  // namespace koboshi::mechanics
