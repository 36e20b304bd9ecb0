#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/world/free_body.h"
#include "sim_board/world/gravity.h"
#include "sim_board/world/ground.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim_board {

// Solver of the equations of motion.
//   kWorld  ODE, exact contact solver (Dantzig): the reference, slow
//   kLumped ODE's contacts, exact solver in joint coordinates; hinges that intersect in one point are merged,
//           the links between them move with their neighbours, and a resting sole is one constraint; the
//           default of scenarios
//   kMujoco MuJoCo, the second engine: joint coordinates, elliptic friction cones
enum class Stepper { kWorld, kLumped, kMujoco };

// Names in scenarios, options and summaries: world, lumped, mujoco.
const std::vector<std::string>& stepper_names();
std::string_view name_of(Stepper stepper);
std::optional<Stepper> stepper_named(std::string_view name);

// How ODE determines the joints that stick. Both methods give the same motion within rounding.
enum class FrictionMethod {
  kRows,         // a bounded row for each slow joint
  kLockAndCheck  // locks slow joints, releases those whose friction does not suffice, and repeats the step;
                 // wrongly guessed joints have a bounded row for some steps
};

struct WorldOptions {
  double step_s = 0.001;  // must divide 1 ms
  Eigen::Vector3d gravity_W_m_per_s2{0.0, 0.0, -kGravity_m_per_s2};
  Stepper stepper = Stepper::kWorld;
  FrictionMethod friction = FrictionMethod::kLockAndCheck;
  GroundDescription ground;
  std::vector<MaterialPair> material_pairs;
  std::vector<FreeBodyDescription> free_bodies;
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();  // initial pose of links[0]
  std::vector<double> joint_positions_rad;                 // initial positions, by joint; empty: all zero
  bool fixed_base = false;                                 // links[0] is fixed to a stand until
                                                           // release_base()
  double max_speed_m_per_s = 100.0;                        // beyond this speed the simulation counts as
                                                           // diverged
  double max_rate_rad_per_s = 1000.0;
  // Limit of the energy gain in J per kg of the robot; beyond it the run ends (engine/guarded_world.h). Zero
  // disables the check.
  double energy_tolerance_J_per_kg = 0.05;
};

// Returns the options with all defaults filled in. Throws std::invalid_argument for options that do not fit
// this robot.
WorldOptions checked(WorldOptions options, const RobotDescription& robot);

// Appends the initial positions of the followers to those of the joints, for with_followers_as_joints().
WorldOptions with_follower_positions(WorldOptions options, const RobotDescription& robot);

}  // namespace koboshi::sim_board
