#pragma once

#include "sim_board/robot/description.h"

namespace koboshi::sim {

// Hand-made robots for tests of the physics; they need no file.

// One free box of uniform density, its frame in the middle.
RobotDescription sample_box(double mass_kg, const Eigen::Vector3d& size_m);

// A link on a hinge about `axis` whose bearing is to be fixed (WorldOptions::fixed_base). The hinge is at the
// origin, the link's centre of mass `arm_m` along x; its inertia about the hinge is inertia_kg_m2 when arm_m
// is 0.
struct HingeRig {
  double mass_kg = 0.05;
  double inertia_kg_m2 = 1e-4;
  double arm_m = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  double lower_rad = -100.0;
  double upper_rad = 100.0;
};
RobotDescription sample_hinge(const HingeRig& rig);

// A humanoid of the paper's size: 20 hinges, 1.2 kg, feet on z = 0 when links[0] is at (0, 0,
// sample_humanoid_height_m).
inline constexpr double kSampleHumanoidHeight_m = 0.17;
RobotDescription sample_humanoid();

}  // namespace koboshi::sim
