// The behaviour state machine of the controller; its transitions stand in behaviour.h.

#include <algorithm>

#include "firmware/app/controller.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {

namespace cia402 = canopen::cia402;

namespace {

constexpr std::int32_t kMinRamp_us = 500'000;
// How long the drives have for their quick stop before the line falls: twice what they take (50 ms of ramp,
// 100 ms of holding).
constexpr std::uint64_t kQuickStop_us = 300'000;
// Emergency error code of the controller itself: device specific (CiA 301, table 26), with state and reason
// beside it.
constexpr std::uint16_t kErrorBehaviour = 0xFF00;

}  // namespace

void Controller::handle(Event event, Reason reason) {
  if (const auto next = next_state(values_.behaviour.state, event)) enter(*next, reason);
}

void Controller::fail(Reason reason) {
  const auto next = next_state(values_.behaviour.state, Event::kTrouble);
  if (!next) return;
  const drive::JointTrouble& trouble = drives_.trouble();
  values_.behaviour.trouble = trouble.kind;
  values_.behaviour.trouble_joint = trouble.joint;
  values_.behaviour.trouble_code = trouble.error_code;
  values_.behaviour.faults = fixed::add_saturated(values_.behaviour.faults, std::uint16_t{1});
  node_.raise_error(kErrorBehaviour, canopen::error_register::kManufacturer,
                    {static_cast<std::uint8_t>(values_.behaviour.state), static_cast<std::uint8_t>(reason),
                     static_cast<std::uint8_t>(trouble.kind), trouble.joint, 0});
  enter(*next, reason);
}

void Controller::enter(State state, Reason reason) {
  values_.behaviour.state = state;
  values_.behaviour.reason = reason;
  entered_us_ = now_us_;
  if (state != State::kFault) board_.drive_enable.set(makes_torque(state));
  switch (state) {
    case State::kBoot:
      started_us_ = now_us_;
      values_.behaviour.trouble = drive::Trouble::kNone;
      node_.mute(false);
      node_.clear_error(kErrorBehaviour);
      stop_moving();
      impostors_ = 0;
      if (model_valid_) drives_.boot(listens_ ? now_us_ + kListen_us : now_us_);
      listens_ = false;
      sensor_nodes_.reset();
      break;
    case State::kLimp:
    case State::kEmergencyStop:
    case State::kFallen:
      stop_moving();
      drives_.set_goal(drive::Goal::kTorqueOff, now_us_);
      break;
    case State::kEnabling:
    case State::kRighting:
      drives_.set_goal(drive::Goal::kEnabled, now_us_);
      break;
    case State::kSoftStart:
      begin_soft_start();
      break;
    case State::kStanding:
    case State::kMotion:
    case State::kWalking:
    case State::kRolling:
    case State::kRising:
      break;
    case State::kFalling:
    case State::kSteadying:
      stillness_.restart();
      break;
    case State::kLowBattery:
      node_.raise_error(cia402::kErrorUnderVoltage, canopen::error_register::kVoltage, {});
      break;
    case State::kFault:
      interpreter_.abort();
      walker_.abort();
      drives_.set_goal(drive::Goal::kQuickStop, now_us_);
      break;
  }
}

void Controller::stop_moving() {
  node_.clear_error(cia402::kErrorUnderVoltage);
  interpreter_.abort();
  walker_.abort();
  fall_watch_.disarm();
  stillness_.restart();
}

void Controller::run_state(std::uint64_t now_us) {
  switch (values_.behaviour.state) {
    case State::kBoot:
      return run_boot(now_us);
    case State::kEnabling:
      return run_enabling();
    case State::kSoftStart:
      return run_soft_start();
    case State::kMotion:
      return run_motion();
    case State::kWalking:
      return run_walking();
    case State::kFault:
      return run_fault(now_us);
    case State::kLimp:
    case State::kEmergencyStop:
      return follow_actual();
    case State::kStanding:
      return run_standing();
    case State::kLowBattery:
      return;
    case State::kFalling:
      return run_falling(now_us);
    case State::kFallen:
      return run_fallen(now_us);
    case State::kRighting:
      return run_righting();
    case State::kRolling:
    case State::kRising:
      return run_getting_up();
    case State::kSteadying:
      return run_steadying(now_us);
  }
}

void Controller::run_boot(std::uint64_t now_us) {
  if (!model_valid_) return fail(Reason::kModelInvalid);
  if (!drives_.booted() || silent_sensor(now_us) != Reason::kNone) return;
  follow_actual();
  handle(Event::kReady, Reason::kProgress);
}

void Controller::run_enabling() {
  follow_actual();
  if (drives_.enabled()) handle(Event::kEnabled, Reason::kProgress);
}

void Controller::begin_soft_start() {
  ramp_from_ = targets_;
  ramp_to_ = targets_;
  motion::Motion standing;
  const bool known = open_motion(0, standing);
  std::int64_t longest_raw = 0;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const bool posed = known && standing.pose_count() > 0 && (standing.joint_mask(0) >> joint & 1u) != 0;
    if (posed) ramp_to_[joint] = standing.angle(0, joint);
    const std::int64_t way_raw = std::int64_t{ramp_to_[joint].raw()} - ramp_from_[joint].raw();
    longest_raw = std::max(longest_raw, way_raw < 0 ? -way_raw : way_raw);
  }
  // The angle has 32 binary places, the rate 12: raw / (rate * 2^20) seconds.
  const std::int64_t rate_raw = std::int64_t{values_.parameters.ramp_rate} << 20;
  const std::int64_t time_us = (longest_raw * 1'000'000 + rate_raw - 1) / rate_raw;
  ramp_time_us_ = std::max(kMinRamp_us, static_cast<std::int32_t>(time_us));
  ramp_elapsed_us_ = 0;
}

void Controller::run_soft_start() {
  ramp_elapsed_us_ += std::int32_t{kTick_us};
  const fixed::Ratio fraction = fixed::elapsed_fraction(ramp_elapsed_us_, ramp_time_us_);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    targets_[joint] = fixed::interpolate(ramp_from_[joint], ramp_to_[joint], fraction);
  }
  if (ramp_elapsed_us_ >= ramp_time_us_) handle(Event::kArrived, Reason::kProgress);
}

void Controller::run_standing() {
  if (battery_low()) handle(Event::kLowBattery, Reason::kSupplyLow);
}

void Controller::run_motion() {
  if (battery_low()) interpreter_.stop();
  interpreter_.advance(kTick_us);
  std::ranges::copy(interpreter_.targets(), targets_.begin());
  if (!interpreter_.running()) handle(Event::kEnded, Reason::kProgress);
}

void Controller::run_walking() {
  if (battery_low()) walker_.stop();
  walker_.advance(
      values_.velocity,
      {.roll = attitude_.roll(), .pitch = attitude_.pitch(), .rates = rates_, .loads = foot_loads_});
  std::ranges::copy(walker_.targets(), targets_.begin());
  if (!walker_.running()) handle(Event::kEnded, Reason::kProgress);
}

void Controller::run_fault(std::uint64_t now_us) {
  if (drives_.all_limp() || now_us - entered_us_ >= kQuickStop_us) board_.drive_enable.set(false);
}

void Controller::follow_actual() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) targets_[joint] = drives_.angle(joint);
}

}  // namespace koboshi::app
