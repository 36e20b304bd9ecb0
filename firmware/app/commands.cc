// What the controller is told over the bus.

#include "firmware/app/controller.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::app {

using namespace fixed::literals;
using canopen::AbortCode;

namespace {

constexpr std::uint8_t kCommand = 1;  // sub-index of kRequestObject
// By sub-index, from 1.
constexpr std::int16_t walk::Velocity::*kVelocityParts[] = {
    &walk::Velocity::forward_mm_per_s, &walk::Velocity::left_mm_per_s, &walk::Velocity::turn_mrad_per_s};
constexpr std::int16_t walk::VelocityLimits::*kVelocityLimits[] = {
    &walk::VelocityLimits::forward_mm_per_s, &walk::VelocityLimits::backward_mm_per_s,
    &walk::VelocityLimits::sideways_mm_per_s, &walk::VelocityLimits::turn_mrad_per_s};
// An encoder may stand this far outside the joint's limits: backlash and offset of a robot that leans on its
// stops. The first target then draws the joint back to its limit.
constexpr fixed::Angle kEncoderMargin = 2.0_deg;
// Half and one and a half g: whatever the attitude, a robot at rest measures about one.
constexpr fixed::Acceleration kMinAcceleration = 4.9_m_per_s2;
constexpr fixed::Acceleration kMaxAcceleration = 14.7_m_per_s2;

}  // namespace

AbortCode Controller::on_write(canopen::ObjectAddress address, std::uint32_t value) {
  if (address.index == kVelocityObject) {
    return set_velocity(address.subindex, static_cast<std::int16_t>(value));
  }
  if (address.index == kVelocityLimitsObject) {
    set_velocity_limit(address.subindex, static_cast<std::int16_t>(value));
  }
  if (address.index >= kTrimObject && address.index <= kGyroBiasObject) {
    return set_calibration(address, static_cast<std::int32_t>(value));
  }
  if (address.index == kNmtStartupObject) {
    const bool known = (value & ~kNmtStartupBits) == 0 && (value & kNmtMaster) != 0;
    return known ? AbortCode::kNone : AbortCode::kInvalidValue;
  }
  if (address != canopen::ObjectAddress{kRequestObject, kCommand}) return AbortCode::kNone;
  const Reason refusal = obey(static_cast<Command>(value), values_.request.argument);
  if (refusal == Reason::kNone) return AbortCode::kNone;
  return refusal == Reason::kUnknownCommand ? AbortCode::kInvalidValue : AbortCode::kDeviceState;
}

canopen::Domain* Controller::domain(canopen::ObjectAddress address) {
  const auto number = static_cast<std::uint16_t>(address.subindex - 1);
  motion_transfer_.select(number, motion_image(number), may_store(values_.behaviour.state));
  return &motion_transfer_;
}

AbortCode Controller::on_store(canopen::ParameterGroup) {
  return parameters_.store(canopen::ParameterGroup::kAll, may_store(values_.behaviour.state));
}

AbortCode Controller::on_restore(canopen::ParameterGroup) {
  return parameters_.restore(canopen::ParameterGroup::kAll, may_store(values_.behaviour.state));
}

void Controller::on_rpdo(std::size_t number) {
  if (number >= kFirstDriveRpdo) return drives_.on_answer(number - kFirstDriveRpdo);
  if (number == kVelocityRpdo) return take_velocity();
  static_cast<void>(obey(values_.request.command, values_.request.argument));
}

AbortCode Controller::set_calibration(canopen::ObjectAddress address, std::int32_t value) {
  const std::size_t number = address.subindex - 1u;
  if (address.index == kTrimObject) {
    set_trim(number, static_cast<std::int16_t>(value));
    return AbortCode::kNone;
  }
  // They turn the attitude and what the gyro feedback makes of it.
  if (makes_torque(values_.behaviour.state)) return AbortCode::kDeviceState;
  Calibration calibration = values_.calibration;
  if (address.index == kMountingObject) calibration.mounting[number] = static_cast<std::int16_t>(value);
  if (address.index == kGyroBiasObject) calibration.gyro_bias[number] = value;
  apply_calibration(calibration);
  return AbortCode::kNone;
}

void Controller::set_trim(std::size_t joint, std::int16_t trim) {
  std::int16_t& present = values_.calibration.trims[joint];
  change_trim(model_.joints[joint].drive, present, trim);
  present = trim;
}

void Controller::apply_calibration(const Calibration& calibration) {
  model_.R_BI = mounted(R_BI_, calibration.mounting);
  const auto& bias = calibration.gyro_bias;
  gyro_bias_.assume({fixed::AngularRate::from_raw(bias[0]), fixed::AngularRate::from_raw(bias[1]),
                     fixed::AngularRate::from_raw(bias[2])});
}

// The second begins now. Should the robot move in it, the refusal comes later.
Reason Controller::calibrate() {
  if (!rests(values_.behaviour.state)) return Reason::kNotInThisState;
  gyro_bias_.interrupt();
  calibrating_ = true;
  return Reason::kNone;
}

AbortCode Controller::set_velocity(std::uint8_t subindex, std::int16_t value) {
  const auto part = kVelocityParts[subindex - 1];
  if (value > values_.velocity_limits.highest().*part) return AbortCode::kValueTooHigh;
  if (value < values_.velocity_limits.lowest().*part) return AbortCode::kValueTooLow;
  velocity_.*part = value;
  return AbortCode::kNone;
}

void Controller::set_velocity_limit(std::uint8_t subindex, std::int16_t value) {
  walk::VelocityLimits limits = values_.velocity_limits;
  limits.*kVelocityLimits[subindex - 1] = value;
  velocity_ = clamped(velocity_, limits);
  values_.velocity = velocity_;
}

// A PDO has put the velocity into its place already. One that is obeyed withdraws the refusal of a velocity
// only: they come often, and the refusal of a command is to be seen.
void Controller::take_velocity() {
  Reason& refusal = values_.behaviour.refusal;
  if (clamped(values_.velocity, values_.velocity_limits) == values_.velocity) {
    velocity_ = values_.velocity;
    if (refusal == Reason::kVelocityOutOfRange) refusal = Reason::kNone;
  } else {
    values_.velocity = velocity_;
    refusal = Reason::kVelocityOutOfRange;
  }
}

Reason Controller::obey(Command command, std::int16_t argument) {
  values_.behaviour.refusal = try_to_obey(command, argument);
  return values_.behaviour.refusal;
}

Reason Controller::try_to_obey(Command command, std::int16_t argument) {
  switch (command) {
    case Command::kNone:
      return Reason::kNone;
    case Command::kEnable:
      return enable();
    case Command::kLimp:
      return obey_event(Event::kLimp);
    case Command::kPlay:
      return play(argument);
    case Command::kStop:
      return stop();
    case Command::kWalk:
      return walk();
    case Command::kEmergencyStop:
      return obey_event(Event::kEmergencyStop);
    case Command::kReset:
      return obey_event(Event::kReset);
    case Command::kCalibrate:
      return calibrate();
    case Command::kGetUp:
      return get_up();
  }
  return Reason::kUnknownCommand;
}

Reason Controller::obey_event(Event event) {
  if (!next_state(values_.behaviour.state, event)) return Reason::kNotInThisState;
  handle(event, Reason::kCommand);
  return Reason::kNone;
}

Reason Controller::enable() {
  if (values_.behaviour.state != State::kLimp) return Reason::kNotInThisState;
  const Reason refusal = refusal_to_enable();
  return refusal == Reason::kNone ? obey_event(Event::kEnable) : refusal;
}

Reason Controller::refusal_to_enable() const {
  const auto& parameters = values_.parameters;
  if (!drives_.all_in(canopen::cia402::State::kSwitchOnDisabled)) return Reason::kDriveNotReady;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if (!drives_.within_limits(joint, kEncoderMargin)) return Reason::kEncoderBeyondLimits;
    const std::uint32_t supply_mV = drives_.supply_mV(joint);
    if (supply_mV < parameters.supply_min_mV || supply_mV > parameters.supply_max_mV) {
      return Reason::kSupplyOutOfRange;
    }
  }
  const auto a = inertial_.accelerations();
  const fixed::Acceleration magnitude = fixed::hypotenuse(a.x, a.y, a.z);
  const bool plausible = magnitude > kMinAcceleration && magnitude < kMaxAcceleration;
  return plausible ? Reason::kNone : Reason::kImuImplausible;
}

Reason Controller::play(std::int16_t number) {
  if (values_.behaviour.state != State::kStanding) return Reason::kNotInThisState;
  motion::Motion motion;
  if (number < 0 || number >= static_cast<std::int16_t>(kMaxMotions)) return Reason::kNoSuchMotion;
  if (!open_motion(static_cast<std::uint16_t>(number), motion)) return Reason::kNoSuchMotion;
  values_.behaviour.motion = static_cast<std::uint8_t>(number);
  interpreter_.start(motion, {targets_.data(), model_.joint_count});
  return obey_event(Event::kPlay);
}

// A robot that walks already only hears its velocity, and forgets that it was to stop.
Reason Controller::walk() {
  if (values_.behaviour.state == State::kWalking) {
    walker_.go_on();
    return Reason::kNone;
  }
  if (values_.behaviour.state == State::kStanding) {
    walker_.start(values_.walk, {targets_.data(), model_.joint_count});
  }
  return obey_event(Event::kWalk);
}

Reason Controller::get_up() {
  if (values_.behaviour.state != State::kLimp) return Reason::kNotInThisState;
  values_.behaviour.attempts = 0;
  const Reason refusal = refusal_to_enable();
  return refusal == Reason::kNone ? obey_event(Event::kGetUp) : refusal;
}

Reason Controller::stop() {
  switch (values_.behaviour.state) {
    case State::kMotion:
      interpreter_.stop();
      return Reason::kNone;
    case State::kWalking:
      walker_.stop();
      return Reason::kNone;
    default:
      return Reason::kNotInThisState;
  }
}

}  // namespace koboshi::app
