#include "simulation/scenario/player.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/placement.h"
#include "simulation/scenario/make_ground.h"

namespace koboshi::simulation {

namespace {

// Lays a body, whose height is zero, on the ground below it.
sim_board::FreeBodyDescription lain_on_ground(sim_board::FreeBodyDescription body,
                                              const sim_board::GroundDescription& ground) {
  constexpr double kStart_m = 10.0;
  constexpr int kSteps = 40;  // on a slope of 45 degrees each leaves a third of the gap
  if (!ground.present && ground.boxes.empty()) return body;
  const bool is_box = body.shape == sim_board::FreeBodyDescription::Shape::kBox;
  auto p_WF = body.X_WF.translation();
  const double half_m = 0.5 * (is_box ? body.size_m.z() : body.size_m.x());
  p_WF.z() = kStart_m;
  for (int i = 0; i < kSteps; ++i) {
    const double gap_m = sim_board::height_above(ground, Eigen::Vector3d(p_WF)) - half_m;
    if (!std::isfinite(gap_m)) return body;
    p_WF.z() -= gap_m;
  }
  return body;
}

}  // namespace

sim_board::BoardOptions board_options(const Scenario& scenario, const sim_board::RobotDescription& robot) {
  sim_board::BoardOptions options;
  options.seed = scenario.seed;
  options.noise_scale = scenario.noise_scale;
  options.computing_time_us = scenario.computing_time_us;
  options.tick_jitter_us = scenario.tick_jitter_us;

  sim_board::WorldOptions& world = options.world;
  world.step_s = 1e-6 * static_cast<double>(scenario.physics.step_us);
  world.stepper = scenario.physics.stepper;
  world.friction = scenario.physics.friction;
  world.fixed_base = scenario.initial.fixed_base;
  world.ground = make_ground(scenario.ground, scenario.seed);
  for (const NamedMaterialPair& named : scenario.materials) world.material_pairs.push_back(named.pair);
  for (const FreeBody& body : scenario.bodies)
    world.free_bodies.push_back(body.on_ground ? lain_on_ground(body.body, world.ground) : body.body);
  world.joint_positions_rad.assign(robot.joints.size(), 0.0);
  for (const InitialJoint& joint : scenario.initial.joints) {
    for (const auto& [index, sign] : robot.find_joints(joint.joint.text)) {
      world.joint_positions_rad[static_cast<std::size_t>(index)] = sign * joint.position_rad;
    }
  }
  world.X_WB.linear() = scenario.initial.R_WB;
  if (scenario.initial.base_height_m) {
    world.X_WB.translation().z() = *scenario.initial.base_height_m;
  } else {
    const auto X_WLs = sim_board::hinge_tree(robot).poses(world.X_WB, world.joint_positions_rad);
    world.X_WB.translation().z() = lift_onto_ground(robot, X_WLs, world.ground) + scenario.initial.drop_m;
  }
  return options;
}

std::unique_ptr<sim_board::SimBoard> make_board(const Scenario& scenario,
                                                const sim_board::RobotDescription& robot,
                                                const sim_board::BoardOptions& options,
                                                sim_board::ControllerHost& host) {
  try {
    return std::make_unique<sim_board::SimBoard>(robot, options, host);
  } catch (const std::invalid_argument& error) {
    throw InputError(scenario.file, 0,
                     "a world that the physics engine refuses (" + one_line(error.what()) + ")",
                     "one that it can simulate");
  }
}

ScenarioPlayer::ScenarioPlayer(const Scenario& scenario, sim_board::SimBoard& board,
                               std::vector<SdoWrite> parameters)
    : scenario_(scenario),
      board_(board),
      operator_(board, std::move(parameters)),
      commands_(scenario.commands),
      pushes_(scenario.pushes),
      faults_(scenario.faults),
      held_(scenario.initial.release_us.has_value()) {
  for (const Push& push : pushes_)
    pushed_links_.push_back(*board.electronics().robot().find_link(push.link.text));
  for (std::size_t i = 0; i < faults_.size(); ++i) schedule(i);
  for (const FaultEvent& event : fault_events_) {
    const Fault& fault = faults_[event.fault];
    if (event.begins && fault.kind == Fault::Kind::kBabblingNode) add_babbler(fault);
  }
  board_.set_step_listener(this);
}

void ScenarioPlayer::act() {
  const std::uint64_t now_us = board_.now_us();
  operator_.advance();
  for (; operator_.ready() && next_command_ < commands_.size(); ++next_command_) {
    if (commands_[next_command_].at_us > now_us) break;
    operator_.command(commands_[next_command_]);
  }
  for (; next_fault_event_ < fault_events_.size(); ++next_fault_event_) {
    const FaultEvent& event = fault_events_[next_fault_event_];
    if (event.at_us > now_us) break;
    const Fault& fault = faults_[event.fault];
    if (event.begins) {
      cause(fault);
    } else {
      mend(fault);
    }
  }
  if (held_ && now_us >= *scenario_.initial.release_us) {
    board_.world().release_base();
    held_ = false;
  }
}

void ScenarioPlayer::command(Command command) {
  command.at_us = board_.now_us();
  commands_.insert(std::ranges::upper_bound(commands_, command.at_us, {}, &Command::at_us), command);
}

void ScenarioPlayer::push(Push push) {
  push.at_us = board_.now_us();
  const auto place = std::ranges::upper_bound(pushes_, push.at_us, {}, &Push::at_us);
  pushed_links_.insert(pushed_links_.begin() + (place - pushes_.begin()),
                       *board_.electronics().robot().find_link(push.link.text));
  pushes_.insert(place, std::move(push));
}

void ScenarioPlayer::fault(Fault fault) {
  fault.at_us = board_.now_us();
  faults_.push_back(std::move(fault));
  schedule(faults_.size() - 1);
}

// Inserts the events of a fault behind those that have happened, in order.
void ScenarioPlayer::schedule(std::size_t fault) {
  const auto insert = [this](FaultEvent event) {
    const auto place = std::ranges::upper_bound(
        fault_events_.begin() + static_cast<std::ptrdiff_t>(next_fault_event_), fault_events_.end(),
        std::tuple(event.at_us, event.begins, event.fault), {},
        [](const FaultEvent& other) { return std::tuple(other.at_us, other.begins, other.fault); });
    fault_events_.insert(place, event);
  };
  insert({faults_[fault].at_us, true, fault});
  if (faults_[fault].duration_us) insert({faults_[fault].end_us(), false, fault});
}

void ScenarioPlayer::before_step(sim_board::World& world, std::uint64_t start_us, std::uint64_t end_us) {
  for (std::size_t i = 0; i < pushes_.size(); ++i) {
    const Push& push = pushes_[i];
    if (push.at_us >= end_us || push.at_us + push.duration_us <= start_us) continue;
    const sim_board::LinkDescription& link =
        board_.electronics().robot().links[static_cast<std::size_t>(pushed_links_[i])];
    world.push(pushed_links_[i], push.p_L_m.value_or(link.p_LCom_L), push.mean_force_W_N(start_us, end_us));
  }
}

std::size_t ScenarioPlayer::joint_of(const Fault& fault) const {
  return static_cast<std::size_t>(*board_.electronics().robot().find_joint(fault.target.text));
}

void ScenarioPlayer::cause(const Fault& fault) {
  switch (fault.kind) {
    case Fault::Kind::kDriveSilent:
      return board_.electronics().hang_drive(joint_of(fault));
    case Fault::Kind::kDrivePowerLoss:
      return board_.electronics().cut_drive_power(joint_of(fault));
    case Fault::Kind::kEncoderBreak:
      return board_.electronics().break_encoder(joint_of(fault));
    case Fault::Kind::kDriveOverheat:
      return board_.electronics().overheat_drive(joint_of(fault));
    case Fault::Kind::kSupplyDrop:
      return board_.electronics().limit_supply(fault.highest_V);
    case Fault::Kind::kBatteryDischarge:
      return board_.electronics().discharge_battery(fault.open_circuit_V, fault.over_us);
    case Fault::Kind::kImuStop:
      return board_.electronics().set_imu_running(false);
    case Fault::Kind::kAnkleStop:
      return board_.electronics().set_ankle_running(fault.side, false);
    case Fault::Kind::kControllerStop:
      return board_.electronics().set_controller_running(false);
    case Fault::Kind::kBusUnacknowledged:
      return board_.electronics().isolate_controller();
    case Fault::Kind::kBusDominant:
      return board_.electronics().bus().set_dominant(true);
    case Fault::Kind::kFramesLost:
    case Fault::Kind::kFramesCorrupted:
    case Fault::Kind::kFramesDelayed:
    case Fault::Kind::kFramesDoubled:
      return disturb_frames(fault);
    // The babbler is attached at the start and starts by its own schedule.
    case Fault::Kind::kBabblingNode:
      return;
  }
}

void ScenarioPlayer::add_babbler(const Fault& fault) {
  sim_board::Babble babble = fault.babble;
  babble.from_us = fault.at_us;
  babble.until_us = fault.end_us();
  board_.electronics().add_babbler(babble);
}

void ScenarioPlayer::disturb_frames(const Fault& fault) {
  sim_board::FrameFault frames = fault.frames;
  if (fault.target.text == kControllerTarget) {
    frames.node = board_.electronics().controller_bus_handle();
  } else if (!fault.target.text.empty()) {
    frames.node = board_.electronics().drive(joint_of(fault)).bus_handle();
  }
  frames.from_us = fault.at_us;
  frames.until_us = fault.end_us();
  board_.electronics().add_frame_fault(frames);
}

void ScenarioPlayer::mend(const Fault& fault) {
  switch (fault.kind) {
    case Fault::Kind::kDriveSilent:
    case Fault::Kind::kDrivePowerLoss:
      return board_.electronics().restart_drive(joint_of(fault));
    case Fault::Kind::kSupplyDrop:
      return board_.electronics().limit_supply(std::nullopt);
    case Fault::Kind::kImuStop:
      return board_.electronics().set_imu_running(true);
    case Fault::Kind::kAnkleStop:
      return board_.electronics().set_ankle_running(fault.side, true);
    case Fault::Kind::kControllerStop:
      return board_.electronics().set_controller_running(true);
    case Fault::Kind::kBusUnacknowledged:
      return board_.electronics().rejoin_controller();
    case Fault::Kind::kBusDominant:
      return board_.electronics().bus().set_dominant(false);
    // Frame faults end by their own schedule, to the microsecond.
    case Fault::Kind::kFramesLost:
    case Fault::Kind::kFramesCorrupted:
    case Fault::Kind::kFramesDelayed:
    case Fault::Kind::kFramesDoubled:
    case Fault::Kind::kBabblingNode:
    // These faults have no end.
    case Fault::Kind::kEncoderBreak:
    case Fault::Kind::kDriveOverheat:
    case Fault::Kind::kBatteryDischarge:
      return;
  }
}

void ScenarioPlayer::archive(sim_board::StateArchive& archive) {
  archive(operator_, commands_, pushes_, pushed_links_, next_command_, faults_, fault_events_,
          next_fault_event_, held_);
}

}  // namespace koboshi::simulation
