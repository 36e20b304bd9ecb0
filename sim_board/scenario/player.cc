#include "sim_board/scenario/player.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "sim_board/world/link_tree.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim {
namespace {

Eigen::Vector3d ground_normal(const Ground& ground) {
  const Eigen::AngleAxisd roll(ground.roll_rad, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd pitch(ground.pitch_rad, Eigen::Vector3d::UnitY());
  return pitch * (roll * Eigen::Vector3d::UnitZ());
}

// How far the lowest corner of the robot's boxes lies below the ground plane, for a base at the origin.
double depth_below(const RobotDescription& robot, const Eigen::Vector3d& normal_W,
                   const WorldOptions& options) {
  double depth_m = 0.0;
  const auto X_WLs = LinkTree(robot).poses(robot, options.X_WB, options.joint_positions_rad);
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    for (const BoxDescription& box : robot.links[l].collisions) {
      const Eigen::Isometry3d X_WG = X_WLs[l] * box.X_LG;
      const double centre_m = normal_W.dot(X_WG.translation());
      const double reach_m = (X_WG.linear().transpose() * normal_W).cwiseAbs().dot(0.5 * box.size_m);
      depth_m = std::max(depth_m, reach_m - centre_m);
    }
  }
  return depth_m;
}

}  // namespace

BoardOptions board_options(const Scenario& scenario, const RobotDescription& robot) {
  BoardOptions options;
  options.seed = scenario.seed;
  options.noise_scale = scenario.noise_scale;
  options.computing_time_us = scenario.computing_time_us;

  WorldOptions& world = options.world;
  world.step_s = 1e-6 * static_cast<double>(scenario.physics.step_us);
  world.stepper = scenario.physics.stepper;
  world.quick_iterations = scenario.physics.quick_iterations;
  world.friction = scenario.physics.friction;
  world.fixed_base = scenario.initial.fixed_base;
  world.ground.normal_W = ground_normal(scenario.ground);
  if (scenario.ground.friction) {
    world.ground.surface.friction = world.ground.surface.friction_second = *scenario.ground.friction;
  }
  if (scenario.ground.softness) {
    SurfaceDescription& surface = world.ground.surface;
    const Softness soft = softness(scenario.ground.softness->stiffness_N_per_m,
                                   scenario.ground.softness->damping_N_s_per_m, surface.reference_step_s);
    surface.error_reduction = soft.error_reduction;
    surface.constraint_force_mixing = soft.constraint_force_mixing;
  }
  world.joint_positions_rad.assign(robot.joints.size(), 0.0);
  for (const InitialJoint& joint : scenario.initial.joints) {
    world.joint_positions_rad[static_cast<std::size_t>(*robot.find_joint(joint.joint.text))] =
        joint.position_rad;
  }
  const double height_m = scenario.initial.base_height_m.value_or(
      (depth_below(robot, world.ground.normal_W, world) / world.ground.normal_W.z()) +
      scenario.initial.drop_m);
  world.X_WB.translation().z() = height_m;
  return options;
}

ScenarioPlayer::ScenarioPlayer(const Scenario& scenario, SimBoard& board, std::vector<SdoWrite> parameters)
    : scenario_(scenario),
      board_(board),
      operator_(board, std::move(parameters)),
      held_(scenario.initial.release_us.has_value()) {
  for (const Push& push : scenario.pushes) {
    pushed_links_.push_back(*board.robot().find_link(push.link.text));
  }
  board_.set_step_listener(this);
}

void ScenarioPlayer::advance() {
  const std::uint64_t now_us = board_.now_us();
  operator_.advance();
  for (; operator_.ready() && next_command_ < scenario_.commands.size(); ++next_command_) {
    if (scenario_.commands[next_command_].at_us > now_us) break;
    operator_.command(scenario_.commands[next_command_]);
  }
  for (; next_fault_ < scenario_.faults.size(); ++next_fault_) {
    if (scenario_.faults[next_fault_].at_us > now_us) break;
    cause(scenario_.faults[next_fault_]);
  }
  if (held_ && now_us >= *scenario_.initial.release_us) {
    board_.world().release_base();
    held_ = false;
  }
  board_.advance();
}

void ScenarioPlayer::before_step(World& world, std::uint64_t start_us, std::uint64_t end_us) {
  for (std::size_t i = 0; i < scenario_.pushes.size(); ++i) {
    const Push& push = scenario_.pushes[i];
    if (push.at_us >= end_us || push.at_us + push.duration_us <= start_us) continue;
    const LinkDescription& link = board_.robot().links[static_cast<std::size_t>(pushed_links_[i])];
    world.push(pushed_links_[i], push.p_L_m.value_or(link.p_LCom_L), push.mean_force_W_N(start_us, end_us));
  }
}

void ScenarioPlayer::cause(const Fault& fault) {
  const auto joint = [&] { return static_cast<std::size_t>(*board_.robot().find_joint(fault.target.text)); };
  switch (fault.kind) {
    case Fault::Kind::kDriveSilent:
      return board_.hang_drive(joint());
    case Fault::Kind::kDrivePowerLoss:
      return board_.cut_drive_power(joint());
    case Fault::Kind::kImuStop:
      return board_.stop_imu();
    case Fault::Kind::kAnkleStop:
      return board_.stop_ankle(fault.side);
    case Fault::Kind::kControllerStop:
      return board_.stop_controller();
    case Fault::Kind::kBusUnacknowledged:
      return board_.isolate_controller();
  }
}

}  // namespace koboshi::sim
