#include "firmware/app/requests.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "hal/port/period.h"

namespace koboshi::app {

using behaviour::Command;
using behaviour::Reason;
using canopen::AbortCode;

namespace {

// Angles of the stream's objects have 16 fraction bits.
constexpr std::int32_t kStreamUnit_raw = 1 << (fixed::Angle::kFractionBits - 16);
// A counter that lies so far behind the highest one is that of a late set. One further behind has skipped
// sets and wrapped, or begins anew: no set is later than the stream's deadline after a reset.
constexpr std::uint8_t kMaxLateSets = kStreamDeadline_ms * 1000u / hal::kControlPeriod_us;
// By sub-index, from 1.
constexpr std::int16_t walk::Velocity::*kVelocityParts[] = {
    &walk::Velocity::forward_mm_per_s, &walk::Velocity::left_mm_per_s, &walk::Velocity::turn_mrad_per_s};
constexpr std::int16_t walk::VelocityLimits::*kVelocityLimits[] = {
    &walk::VelocityLimits::forward_mm_per_s, &walk::VelocityLimits::backward_mm_per_s,
    &walk::VelocityLimits::lateral_mm_per_s, &walk::VelocityLimits::turn_mrad_per_s};

}  // namespace

AbortCode Requests::write(canopen::ObjectAddress address, std::uint32_t value, std::uint64_t now_us) {
  switch (address.index) {
    case kVelocityObject:
      return set_velocity(address.subindex, static_cast<std::int16_t>(value));
    case kVelocityLimitsObject:
      set_velocity_limit(address.subindex, static_cast<std::int16_t>(value));
      return AbortCode::kNone;
    case kStreamObject:
      return take_set(static_cast<std::uint8_t>(value)) ? AbortCode::kNone : AbortCode::kDeviceState;
    case kTrimObject:
    case kMountingObject:
    case kGyroBiasObject:
      return set_calibration(address, static_cast<std::int32_t>(value));
    case kNmtStartupObject: {
      const bool known = (value & ~kNmtStartupBits) == 0 && (value & kNmtMaster) != 0;
      return known ? AbortCode::kNone : AbortCode::kInvalidValue;
    }
    case kRequestObject:
      if (address.subindex == kCommandSubindex)
        return execute(static_cast<Command>(value), values_.request.argument, now_us);
      return AbortCode::kNone;
    default:
      return AbortCode::kNone;
  }
}

bool Requests::take_command(std::uint64_t now_us) {
  // A client that commands by PDO finds in telemetry that the state does not permit it.
  return execute(values_.request.command, values_.request.argument, now_us) != AbortCode::kInvalidValue;
}

bool Requests::take_velocity() { return request(values_.velocity) != Reason::kVelocityOutOfRange; }

// The one check of a velocity, whatever service brought it. The object always shows the velocity in force.
Reason Requests::request(const walk::Velocity& velocity) {
  const Reason refusal = behaviour_.request_velocity(velocity);
  values_.velocity = behaviour_.velocity();
  return refusal;
}

AbortCode Requests::execute(Command command, std::int16_t argument, std::uint64_t now_us) {
  const Reason refusal = behaviour_.request(command, argument,
                                            {.robot = estimator_.state(),
                                             .drives = drives_.enable_conditions(),
                                             .values = bus_values(values_),
                                             .now_us = now_us});
  if (refusal == Reason::kUnknownCommand) return AbortCode::kInvalidValue;
  if (refusal != Reason::kNone) return AbortCode::kDeviceState;
  if (command == Command::kCalibrate) estimator_.begin_calibration();
  if (command == Command::kStream) begin_stream();
  return AbortCode::kNone;
}

// The objects begin with the present targets and full torque: a program that sends some joints only leaves
// the others where they are.
void Requests::begin_stream() {
  const behaviour::Decision& decision = behaviour_.decision();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const std::int64_t raw = fixed::shift_rounded(std::int64_t{decision.targets[joint].raw()}, 16);
    values_.stream.targets[joint] = fixed::saturate<std::int16_t>(raw);
    values_.stream.torques_percent[joint] = 0;
  }
  last_set_.reset();
}

bool Requests::take_set(std::uint8_t sequence) {
  auto& stream = values_.stream;
  std::array<fixed::Angle, robot::kMaxJoints> targets{};
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    targets[joint] = fixed::Angle::from_raw(std::int32_t{stream.targets[joint]} * kStreamUnit_raw);
  if (!behaviour_.take_stream(targets, stream.torques_percent)) return false;
  stream.taken_sets = fixed::add_saturated(stream.taken_sets, std::uint16_t{1});
  count_missing_sets(sequence);
  return true;
}

// A set that repeats the counter or comes late skips none: the gap before a late set has been counted.
void Requests::count_missing_sets(std::uint8_t sequence) {
  const auto back = static_cast<std::uint8_t>(last_set_ ? *last_set_ - sequence : 0);
  if (last_set_ && back <= kMaxLateSets) return;
  const auto missing = static_cast<std::uint8_t>(last_set_ ? sequence - *last_set_ - 1 : 0);
  last_set_ = sequence;
  values_.stream.missing_sets = fixed::add_saturated(values_.stream.missing_sets, std::uint16_t{missing});
}

AbortCode Requests::set_velocity(std::uint8_t subindex, std::int16_t value) {
  const auto part = kVelocityParts[subindex - 1];
  walk::Velocity velocity = behaviour_.velocity();
  velocity.*part = value;
  const Reason refusal = request(velocity);
  if (refusal == Reason::kNone) return AbortCode::kNone;
  if (refusal != Reason::kVelocityOutOfRange) return AbortCode::kDeviceState;
  return value > behaviour_.velocity().*part ? AbortCode::kValueTooHigh : AbortCode::kValueTooLow;
}

void Requests::set_velocity_limit(std::uint8_t subindex, std::int16_t value) {
  walk::VelocityLimits limits = values_.velocity_limits;
  limits.*kVelocityLimits[subindex - 1] = value;
  behaviour_.clamp_velocity(limits);
  values_.velocity = behaviour_.velocity();
}

AbortCode Requests::set_calibration(canopen::ObjectAddress address, std::int32_t value) {
  const std::size_t number = address.subindex - 1u;
  if (address.index == kTrimObject) {
    set_trim(number, static_cast<std::int16_t>(value));
    return AbortCode::kNone;
  }
  // They would turn the estimated attitude under a feedback that is active.
  if (behaviour::kTorque.contains(behaviour_.state())) return AbortCode::kDeviceState;
  Calibration calibration = values_.calibration;
  if (address.index == kMountingObject) calibration.mounting[number] = static_cast<std::int16_t>(value);
  if (address.index == kGyroBiasObject) calibration.gyro_bias[number] = value;
  apply(calibration);
  return AbortCode::kNone;
}

void Requests::set_trim(std::size_t joint, std::int16_t trim) {
  change_trim(model_.joints[joint].drive, applied_trims_[joint], trim);
  applied_trims_[joint] = trim;
}

void Requests::apply(const Calibration& calibration) {
  model_.R_BI = mounted(R_BI_, calibration.mounting);
  const auto& bias = calibration.gyro_bias;
  estimator_.assume_gyro_bias({fixed::AngularRate::from_raw(bias[0]), fixed::AngularRate::from_raw(bias[1]),
                               fixed::AngularRate::from_raw(bias[2])});
}

void Requests::reset_parameters() {
  values_.nmt_startup = kNmtMaster;
  values_.parameters = {};
  values_.feedback = {};
  values_.velocity_limits = {};
  values_.calibration = {};
  values_.walk = {};
  values_.recovery = {};
  values_.policy.enabled = 0;
}

void Requests::apply_parameters() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    set_trim(joint, values_.calibration.trims[joint]);
  apply(values_.calibration);
  behaviour_.clamp_velocity(values_.velocity_limits);
  values_.velocity = behaviour_.velocity();
}

void Requests::end_calibration() {
  using enum estimation::Estimator::Calibration;
  if (estimator_.calibration() == kMoved) behaviour_.refuse(Reason::kNotAtRest);
  if (estimator_.calibration() != kDone) return;
  const auto& bias = estimator_.gyro_bias();
  const fixed::AngularRate axes[] = {bias.x, bias.y, bias.z};
  std::ranges::transform(axes, values_.calibration.gyro_bias, [](auto rate) { return rate.raw(); });
}

}  // namespace koboshi::app
