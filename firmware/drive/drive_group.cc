#include "firmware/drive/drive_group.h"

#include <algorithm>
#include <span>
#include <utility>

#include "firmware/fixed/saturating.h"

namespace koboshi::drive {

using canopen::cia402::State;
namespace cia402 = canopen::cia402;

namespace {

constexpr std::uint8_t kEveryNode = 0;  // NMT, CiA 301, 7.2.8.2.1

// Communication and protocol errors, 0x81xx and 0x82xx (CiA 301, table 26), of a drive whose error register
// shows no other error (table 48; bit 0 is set with every error): the drive keeps working. The two time-outs
// are no warnings: the drive has lost the controller or its targets.
bool is_warning(const canopen::Emergency& emergency) {
  constexpr auto kHarmless =
      static_cast<std::uint8_t>(canopen::error_register::kGeneric | canopen::error_register::kCommunication);
  const unsigned group = emergency.code >> 8;
  const bool lasting = emergency.code == canopen::error_code::kHeartbeat ||
                       emergency.code == canopen::error_code::kRpdoTimeout;
  return !lasting && (group == 0x81 || group == 0x82) && (emergency.error_register & ~kHarmless) == 0;
}

}  // namespace

DriveGroup::DriveGroup(const robot::RobotModel& model, canopen::FrameSink& sink, DriveSignals& signals)
    : model_(model),
      sink_(sink),
      signals_(signals),
      client_(sink),
      configuration_(client_),
      torque_limits_(model, {canopen::cia402::kMaxTorque, 0}, Setting::kOwn_permille, sink),
      position_gains_(model, {canopen::cia402::kPositionControlParameters, 1}, kMaxPositionGain_permille,
                      sink) {}

void DriveGroup::boot(std::uint64_t reset_us) {
  phase_ = Phase::kResetting;
  reset_us_ = reset_us;
  goal_ = Goal::kTorqueOff;
  client_.reset();
  torque_limits_.reset();
  position_gains_.reset();
  addressed_ = 0;
  configured_ = 0;
  present_ = 0;
  repeated_ = 0;
  has_answered_ = 0;
  answered_ = 0;
  missed_ = {};
  enabled_ = false;
  fault_ = {};
  error_code_ = {};
  signals_ = {};
}

void DriveGroup::set_goal(Goal goal, std::uint64_t now_us) {
  goal_ = goal;
  enabled_ = false;
  enable_deadline_us_ = now_us + kEnableTimeout_us;
}

void DriveGroup::on_heartbeat(const canopen::HeartbeatEvent& event) {
  std::size_t joint = 0;
  if (phase_ == Phase::kIdle || !find(event.node_id, joint)) return;
  if (event.kind == canopen::HeartbeatEventKind::kBootedUp) on_boot_up(joint);
  if (event.kind == canopen::HeartbeatEventKind::kLost && phase_ > Phase::kWaiting)
    report(DriveFault::kLost, joint);
}

// The message of a boot just before the reset (power came back, or another master reset the drive) may arrive
// after it, so that a second follows. It harms nothing as long as the drive is not configured.
void DriveGroup::on_boot_up(std::size_t joint) {
  const std::uint32_t bit = 1u << joint;
  if (phase_ == Phase::kResetting && joint >= addressed_) return;
  if (phase_ <= Phase::kWaiting) {
    present_ |= bit;
    return;
  }
  torque_limits_.on_boot_up(joint);
  position_gains_.on_boot_up(joint);
  const bool unconfigured = phase_ == Phase::kConfiguring && joint >= configured_;
  if (!unconfigured || (repeated_ & bit) != 0) return report(DriveFault::kRestarted, joint);
  repeated_ |= bit;
  if (joint == configured_) configuration_.begin(model_.joints[joint]);
}

void DriveGroup::on_emergency(const canopen::Emergency& emergency) {
  std::size_t joint = 0;
  if (!find(emergency.node_id, joint)) return;
  // An emergency from before the boot-up message belongs to the time before the reset.
  if ((present_ >> joint & 1u) == 0) return;
  const bool ended = emergency.code == canopen::error_code::kNoError;
  // One error has ended while the register still shows another: the code of the other is kept.
  if (!ended || emergency.error_register == 0) error_code_[joint] = emergency.code;
  if (!ended && !is_warning(emergency)) report(DriveFault::kFault, joint, emergency.code);
}

void DriveGroup::process(std::uint64_t now_us, Starting starting) {
  client_.process(now_us);
  if (phase_ == Phase::kResetting && now_us >= reset_us_ && send_to_each(canopen::NmtCommand::kResetNode)) {
    phase_ = Phase::kWaiting;
    boot_deadline_us_ = now_us + kBootTimeout_us;
  }
  if (phase_ == Phase::kWaiting) await_boot_ups(now_us);
  if (phase_ == Phase::kConfiguring) configure(now_us);
  if (phase_ == Phase::kStarting) start(starting);
  if (phase_ != Phase::kBooted) return;
  // One SDO at a time: the torque limits first, for a joint may have to become limp.
  torque_limits_.process(client_.state() != canopen::SdoState::kBusy && !position_gains_.busy(), now_us);
  position_gains_.process(client_.state() != canopen::SdoState::kBusy && !torque_limits_.busy(), now_us);
  if (!torque_limits_.busy() && !position_gains_.busy()) read_supply(now_us);
}

void DriveGroup::start(Starting starting) {
  bool started = false;
  switch (starting) {
    case Starting::kLater:
      break;
    case Starting::kEach:
      started = send_to_each(canopen::NmtCommand::kStart);
      break;
    case Starting::kTogether:
      started = send(canopen::NmtCommand::kStart, kEveryNode);
      break;
    case Starting::kByOthers:
      started = answered_ == all_joints();
      break;
  }
  if (!started) return;
  phase_ = Phase::kBooted;
  client_.reset();
}

void DriveGroup::await_boot_ups(std::uint64_t now_us) {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if ((present_ >> joint & 1u) != 0) continue;
    if (now_us < boot_deadline_us_) return;
    report(DriveFault::kSilent, joint);
    phase_ = Phase::kFailed;
    return;
  }
  phase_ = Phase::kConfiguring;
  configuration_.begin(model_.joints[0]);
}

void DriveGroup::configure(std::uint64_t now_us) {
  configuration_.process(now_us);
  if (configuration_.state() == Configuration::State::kFailed) {
    report(configuration_.fault(), configured_);
    phase_ = Phase::kFailed;
  }
  if (configuration_.state() != Configuration::State::kDone) return;
  supply_mV_[configured_++] = configuration_.supply_mV();
  if (configured_ < model_.joint_count) {
    configuration_.begin(model_.joints[configured_]);
    // At once: 27 requests then take just three cycles, of which each tick has a millisecond for itself. So
    // all drives' heartbeats, which count from here, keep one phase in the cycle, behind the answers.
    configuration_.process(now_us);
  } else {
    phase_ = Phase::kStarting;
    addressed_ = 0;
  }
}

// Leaves out a drive that does not answer: its loss is detected elsewhere (watch_answers, heartbeats).
void DriveGroup::read_supply(std::uint64_t now_us) {
  if (client_.state() == canopen::SdoState::kDone) {
    supply_mV_[supplied_] = client_.value();
    reported_supply_mV_ = client_.value();
  }
  if (client_.state() == canopen::SdoState::kBusy) return;
  client_.reset();
  // Asks nothing while other services fill the bus.
  if (now_us < supply_due_us_ || sink_.pending(hal::kBackgroundFifo)) return;
  supply_due_us_ = now_us + kSupplyPeriod_us;
  supplied_ = supplied_ + 1 < model_.joint_count ? supplied_ + 1 : 0;
  // A queue that is full cannot take a request: the next drive is asked one period later.
  static_cast<void>(
      client_.begin_read(model_.joints[supplied_].drive.node_id, {cia402::kSupplyVoltage, 0}, now_us));
}

void DriveGroup::observe(std::uint64_t now_us) {
  new_supply_mV_ = std::exchange(reported_supply_mV_, std::nullopt);
  if (new_supply_mV_ || lowest_supply_mV_ == 0)
    lowest_supply_mV_ = *std::ranges::min_element(std::span(supply_mV_).first(model_.joint_count));
  answering_ = phase_ == Phase::kBooted && answered_ != 0;
  if (phase_ != Phase::kBooted) return;
  watch_answers();
  if (booted()) watch_states(now_us);
}

// A drive that hangs, or is no longer operational, stops sending; its last statusword is then meaningless.
void DriveGroup::watch_answers() {
  if (answered_ == all_joints()) {  // nearly always
    missed_ = {};
  } else {
    count_missed();
  }
  has_answered_ |= answered_;
  answered_ = 0;
}

void DriveGroup::count_missed() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const bool answered = (answered_ >> joint & 1u) != 0;
    if (missed_[joint].update(!answered, kMissedAnswers)) report(DriveFault::kLost, joint);
  }
}

void DriveGroup::watch_states(std::uint64_t now_us) {
  const auto words = std::span(signals_.statusword).first(model_.joint_count);
  const bool all_follow = std::ranges::all_of(words, cia402::follows_command);
  if (enabled_ && all_follow) return;  // nearly always
  const bool due = goal_ == Goal::kEnabled && (enabled_ || now_us >= enable_deadline_us_);
  // Drives that wait for another to be switched on are not to blame.
  const bool waiting = !enabled_ && !all_switched_on();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const State now = state(joint);
    if (now == State::kFault || now == State::kFaultReactionActive)
      report(DriveFault::kFault, joint, error_code_[joint]);
    if (!due) continue;
    const bool led = waiting ? switched_on(joint) : now == State::kOperationEnabled;
    if (!led) report(DriveFault::kNotEnabled, joint);
    if (led && !waiting && !cia402::follows_command(words[joint])) report(DriveFault::kNotFollowing, joint);
  }
  enabled_ = enabled_ || (goal_ == Goal::kEnabled && all_follow);
}

void DriveGroup::command() {
  if (enabled_ && commanded_enabled_) return;  // nearly always: the words of the last cycle hold
  commanded_enabled_ = enabled_;
  const bool last_step = enabled_ || all_switched_on();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    signals_.controlword[joint] = controlword(joint, last_step);
  }
}

bool DriveGroup::switched_on(std::size_t joint) const {
  const State now = state(joint);
  return now == State::kSwitchedOn || now == State::kOperationEnabled;
}

bool DriveGroup::all_switched_on() const {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if (!switched_on(joint)) return false;
  }
  return true;
}

std::uint16_t DriveGroup::controlword(std::size_t joint, bool last_step) const {
  switch (goal_) {
    case Goal::kTorqueOff:
      return cia402::kControlDisableVoltage;
    case Goal::kQuickStop:
      return cia402::kControlQuickStop;
    case Goal::kEnabled:
      break;
  }
  if (last_step) return cia402::kControlEnableOperation;
  return state(joint) == State::kSwitchOnDisabled ? cia402::kControlShutdown : cia402::kControlSwitchOn;
}

fixed::Angle DriveGroup::angle(std::size_t joint) const {
  KOBOSHI_ASSERT(joint < model_.joint_count);
  return robot::joint_angle(model_.joints[joint].drive, signals_.position[joint]);
}

DriveStatus DriveGroup::status() const {
  DriveStatus status{.configured = configured(),
                     .booted = booted(),
                     .enabled = enabled_,
                     .limp = all_limp(),
                     .fault = fault_,
                     .new_supply_mV = new_supply_mV_,
                     .lowest_supply_mV = lowest_supply_mV_};
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) status.angles[joint] = angle(joint);
  return status;
}

EnableConditions DriveGroup::enable_conditions() const {
  EnableConditions conditions{.disabled = all_in(State::kSwitchOnDisabled), .supply_mV = supply_mV_};
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if (!within_limits(joint)) conditions.beyond_limits |= 1u << joint;
  }
  return conditions;
}

bool DriveGroup::within_limits(std::size_t joint) const {
  const robot::Joint& limits = model_.joints[joint];
  const std::int64_t raw = angle(joint).raw();
  return raw >= std::int64_t{limits.lower.raw()} - kEncoderMargin.raw() &&
         raw <= std::int64_t{limits.upper.raw()} + kEncoderMargin.raw();
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

bool DriveGroup::send(canopen::NmtCommand command, std::uint8_t node_id) {
  return sink_.send(canopen::encode(canopen::NmtMessage{.command = command, .node_id = node_id}));
}

// True once all drives have been sent it; those for which there was no room wait for the next call.
bool DriveGroup::send_to_each(canopen::NmtCommand command) {
  while (addressed_ < model_.joint_count && send(command, model_.joints[addressed_].drive.node_id)) {
    ++addressed_;
  }
  return addressed_ == model_.joint_count;
}

bool DriveGroup::find(std::uint8_t node_id, std::size_t& joint) const {
  for (joint = 0; joint < model_.joint_count; ++joint) {
    if (model_.joints[joint].drive.node_id == node_id) return true;
  }
  return false;
}

void DriveGroup::report(DriveFault kind, std::size_t joint, std::uint16_t error_code) {
  // The first is the cause; what follows is mostly its consequence.
  if (fault_) return;
  fault_ = {.kind = kind, .joint = static_cast<std::uint8_t>(joint), .error_code = error_code};
}

}  // namespace koboshi::drive
