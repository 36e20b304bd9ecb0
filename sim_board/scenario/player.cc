#include "sim_board/scenario/player.h"

#include <utility>

#include "sim_board/scenario/make_ground.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/placement.h"

namespace koboshi::sim {

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
  world.ground = make_ground(scenario.ground, scenario.seed);
  for (const NamedMaterialPair& named : scenario.materials) world.material_pairs.push_back(named.pair);
  world.joint_positions_rad.assign(robot.joints.size(), 0.0);
  for (const InitialJoint& joint : scenario.initial.joints) {
    world.joint_positions_rad[static_cast<std::size_t>(*robot.find_joint(joint.joint.text))] =
        joint.position_rad;
  }
  if (scenario.initial.base_height_m) {
    world.X_WB.translation().z() = *scenario.initial.base_height_m;
  } else {
    const auto X_WLs = LinkTree(robot).poses(robot, world.X_WB, world.joint_positions_rad);
    world.X_WB.translation().z() = lift_onto_ground(robot, X_WLs, world.ground) + scenario.initial.drop_m;
  }
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
