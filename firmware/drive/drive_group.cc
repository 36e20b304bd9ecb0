#include "firmware/drive/drive_group.h"

namespace koboshi::drive {

using canopen::cia402::State;
namespace cia402 = canopen::cia402;

DriveGroup::DriveGroup(const robot::RobotModel& model, canopen::FrameSink& sink, DriveSignals& signals)
    : model_(model), sink_(sink), signals_(signals), client_(sink), configuration_(client_) {}

void DriveGroup::boot() {
  phase_ = Phase::kResetting;
  goal_ = Goal::kTorqueOff;
  configured_ = 0;
  present_ = 0;
  heard_ = false;
  trouble_ = {};
  signals_ = {};
}

void DriveGroup::set_goal(Goal goal, std::uint64_t now_us) {
  goal_ = goal;
  enable_deadline_us_ = now_us + kEnableTimeout_us;
}

void DriveGroup::on_heartbeat(const canopen::HeartbeatEvent& event) {
  std::size_t joint = 0;
  if (!find(event.node_id, joint)) return;
  if (event.kind == canopen::HeartbeatEventKind::kBootedUp) {
    if (phase_ > Phase::kWaiting) report(Trouble::kRestarted, joint);
    present_ |= 1u << joint;
  }
  if (event.kind == canopen::HeartbeatEventKind::kLost && phase_ > Phase::kWaiting)
    report(Trouble::kLost, joint);
}

void DriveGroup::on_emergency(const canopen::Emergency& emergency) {
  std::size_t joint = 0;
  if (emergency.code != canopen::error_code::kNoError && find(emergency.node_id, joint)) {
    report(Trouble::kFault, joint, emergency.code);
  }
}

void DriveGroup::process(std::uint64_t now_us) {
  client_.process(now_us);
  if (phase_ == Phase::kResetting && send(canopen::NmtCommand::kResetNode)) {
    phase_ = Phase::kWaiting;
    boot_deadline_us_ = now_us + kBootTimeout_us;
  }
  if (phase_ == Phase::kWaiting) await_boot_ups(now_us);
  if (phase_ == Phase::kConfiguring) configure(now_us);
  if (phase_ == Phase::kStarting && send(canopen::NmtCommand::kStart)) phase_ = Phase::kBooted;
}

void DriveGroup::await_boot_ups(std::uint64_t now_us) {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if ((present_ >> joint & 1u) != 0) continue;
    if (now_us < boot_deadline_us_) return;
    report(Trouble::kSilent, joint);
    phase_ = Phase::kFailed;
    return;
  }
  phase_ = Phase::kConfiguring;
  configuration_.begin(model_.joints[0]);
}

void DriveGroup::configure(std::uint64_t now_us) {
  configuration_.process(now_us);
  if (configuration_.state() == Configuration::State::kFailed) {
    report(configuration_.trouble(), configured_);
    phase_ = Phase::kFailed;
  }
  if (configuration_.state() != Configuration::State::kDone) return;
  supply_mV_[configured_++] = configuration_.supply_mV();
  if (configured_ < model_.joint_count) {
    configuration_.begin(model_.joints[configured_]);
  } else {
    phase_ = Phase::kStarting;
  }
}

void DriveGroup::tick(std::uint64_t now_us) {
  if (phase_ != Phase::kBooted) return;
  bool all_switched_on = true;
  bool heard = true;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const State now = state(joint);
    heard = heard && now != State::kNotReadyToSwitchOn;
    all_switched_on = all_switched_on && (now == State::kSwitchedOn || now == State::kOperationEnabled);
  }
  heard_ = heard_ || heard;
  if (heard_) watch(now_us);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    signals_.controlword[joint] = controlword(joint, all_switched_on);
  }
}

std::uint16_t DriveGroup::controlword(std::size_t joint, bool all_switched_on) const {
  const State now = state(joint);
  switch (goal_) {
    case Goal::kTorqueOff:
      return cia402::kControlDisableVoltage;
    case Goal::kQuickStop:
      return cia402::kControlQuickStop;
    case Goal::kEnabled:
      break;
  }
  if (all_switched_on) return cia402::kControlEnableOperation;
  return now == State::kSwitchOnDisabled ? cia402::kControlShutdown : cia402::kControlSwitchOn;
}

void DriveGroup::watch(std::uint64_t now_us) {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const State now = state(joint);
    if (now == State::kFault || now == State::kFaultReactionActive) report(Trouble::kFault, joint);
    if (goal_ == Goal::kEnabled && now != State::kOperationEnabled && now_us >= enable_deadline_us_) {
      report(Trouble::kNotEnabled, joint);
    }
  }
}

void DriveGroup::set_target(std::size_t joint, fixed::Angle angle) {
  signals_.target_position[joint] = robot::drive_position(model_.joints[joint].drive, angle);
}

fixed::Angle DriveGroup::angle(std::size_t joint) const {
  return robot::joint_angle(model_.joints[joint].drive, signals_.position[joint]);
}

bool DriveGroup::within_limits(std::size_t joint, fixed::Angle margin) const {
  const robot::Joint& limits = model_.joints[joint];
  const std::int64_t raw = angle(joint).raw();
  return raw >= std::int64_t{limits.lower.raw()} - margin.raw() &&
         raw <= std::int64_t{limits.upper.raw()} + margin.raw();
}

bool DriveGroup::all_in(State wanted) const {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if (state(joint) != wanted) return false;
  }
  return true;
}

bool DriveGroup::all_limp() const {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const State now = state(joint);
    if (now == State::kOperationEnabled || now == State::kQuickStopActive ||
        now == State::kFaultReactionActive) {
      return false;
    }
  }
  return true;
}

bool DriveGroup::send(canopen::NmtCommand command) {
  return sink_.send(canopen::encode(canopen::NmtMessage{.command = command, .node_id = 0}));
}

bool DriveGroup::find(std::uint8_t node_id, std::size_t& joint) const {
  for (joint = 0; joint < model_.joint_count; ++joint) {
    if (model_.joints[joint].drive.node_id == node_id) return true;
  }
  return false;
}

void DriveGroup::report(Trouble kind, std::size_t joint, std::uint16_t error_code) {
  // The first is the cause; what follows is mostly its consequence.
  if (trouble_) return;
  trouble_ = {.kind = kind, .joint = static_cast<std::uint8_t>(joint), .error_code = error_code};
}

}  // namespace koboshi::drive
