#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/world/gravity.h"
#include "sim_board/world/ground.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim {

// Who solves the equations of motion.
//   kWorld  ODE, the contact problem solved exactly: the reference
//   kLumped ODE, solved as exactly; hinges that meet in one point are one joint, the links between them ride
//           on their neighbours, and a sole that stands is one constraint: half the rows
//   kQuick  ODE, iterated (projected successive over-relaxation)
//   kMujoco MuJoCo, the second engine: joint coordinates, elliptic friction cones
enum class Stepper { kWorld, kLumped, kQuick, kMujoco };

// By the names that scenarios, options and summaries use: world, lumped, quick, mujoco.
const std::vector<std::string>& stepper_names();
std::string_view name_of(Stepper stepper);
std::optional<Stepper> stepper_named(std::string_view name);

// How ODE learns which joints stick. Both give the same motion, but for round-off.
enum class FrictionMethod {
  kRows,         // a bounded row for each slow joint
  kLockAndCheck  // slow joints are locked; those whose friction would not suffice are released, and the step
                 // is repeated; joints that were guessed wrong have a bounded row for a while
};

struct WorldOptions {
  double step_s = 0.001;  // must divide 1 ms
  Eigen::Vector3d gravity_W_m_per_s2{0.0, 0.0, -kGravity_m_per_s2};
  Stepper stepper = Stepper::kWorld;
  int quick_iterations = 50;
  FrictionMethod friction = FrictionMethod::kLockAndCheck;  // kQuick always takes rows
  GroundDescription ground;
  std::vector<MaterialPair> material_pairs;
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();  // links[0] at the start
  std::vector<double> joint_positions_rad;                 // at the start, by joint; empty: all zero
  bool fixed_base = false;                                 // links[0] hangs on a stand until release_base()
  double max_speed_m_per_s = 100.0;                        // beyond these a body has blown up
  double max_rate_rad_per_s = 1000.0;
  // Energy from nowhere, J for each kg of the robot, beyond which the run ends (engine/guarded_world.h);
  // zero: nobody looks.
  double energy_tolerance_J_per_kg = 0.05;
};

// The options with all that may be left out filled in. Throws std::invalid_argument for those that make no
// world of this robot.
WorldOptions checked(WorldOptions options, const RobotDescription& robot);

}  // namespace koboshi::sim
