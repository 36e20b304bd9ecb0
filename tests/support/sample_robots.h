#pragma once

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// Hand-made robots for tests of the physics, without a file.

// A free box of uniform density with its frame at the centre.
RobotDescription sample_box(double mass_kg, const Eigen::Vector3d& size_m);

// A link on a hinge about `axis`; use it with WorldOptions::fixed_base. The hinge is at the origin and the
// link's centre of mass `arm_m` along x. If `arm_m` is 0, the inertia about the hinge is inertia_kg_m2.
struct HingeRig {
  double mass_kg = 0.05;
  double inertia_kg_m2 = 1e-4;
  double arm_m = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  double lower_rad = -100.0;
  double upper_rad = 100.0;
};
RobotDescription sample_hinge(const HingeRig& rig);

// A humanoid of the size in the paper: 20 hinges, 1.2 kg. Its feet are on z = 0 when links[0] is at (0, 0,
// sample_humanoid_height_m).
inline constexpr double kSampleHumanoidHeight_m = 0.17;
RobotDescription sample_humanoid();

}  // namespace koboshi::sim_board
