// What the controller sends in each cycle.

#include "firmware/app/controller.h"
#include "firmware/app/telemetry_units.h"

namespace koboshi::app {

namespace {

constexpr fixed::AngularRate beyond(fixed::AngularRate rate, fixed::AngularRate dead_band) {
  if (rate > dead_band) return rate - dead_band;
  return rate < -dead_band ? rate + dead_band : fixed::AngularRate();
}

}  // namespace

void Controller::publish(std::uint64_t now_us) {
  if (!is_operational() || drives_.resetting()) return;
  if (drives_.configured()) command_drives(now_us);
  node_.send_sync(now_us);
}

void Controller::command_drives(std::uint64_t now_us) {
  drives_.command();
  Angles commanded = targets_;
  balance(commanded);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    drives_.set_target(joint, robot::clamp_to_limits(model_.joints[joint], commanded[joint]));
    node_.trigger_tpdo(kFirstDriveTpdo + joint, now_us);
  }
}

balance::TrunkMotion Controller::trunk_motion() const {
  balance::TrunkMotion trunk{
      .roll_rate = rates_.x, .pitch_rate = rates_.y, .roll = attitude_.roll(), .pitch = attitude_.pitch()};
  if (values_.behaviour.state == State::kWalking) trunk.pitch -= walker_.pitch();
  return trunk;
}

void Controller::balance(Angles& targets) const {
  const auto& gains = values_.feedback;
  balance::TrunkMotion trunk = trunk_motion();
  switch (values_.behaviour.state) {
    case State::kStanding:
    case State::kLowBattery:
    case State::kSteadying: {
      const auto quiet = fixed::AngularRate::from_raw(gains.standing_dead_band << 12);
      trunk.roll_rate = beyond(trunk.roll_rate, quiet);
      trunk.pitch_rate = beyond(trunk.pitch_rate, quiet);
      return feedback_.correct(gains.standing, trunk, targets);
    }
    case State::kWalking:
      return feedback_.correct(gains.walking, trunk, targets);
    case State::kMotion:
      return feedback_.correct({.rate = gains.motion, .lean = {}}, trunk, targets);
    default:
      return;
  }
}

void Controller::publish_telemetry() {
  auto& attitude = values_.attitude;
  attitude.roll = narrow(attitude_.roll());
  attitude.pitch = narrow(attitude_.pitch());
  const fixed::AngularRate rate[] = {rates_.x, rates_.y, rates_.z};
  const fixed::Acceleration acceleration[] = {accelerations_.x, accelerations_.y, accelerations_.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    attitude.rate[axis] = narrow(rate[axis]);
    attitude.acceleration[axis] = narrow(acceleration[axis]);
  }
}

}  // namespace koboshi::app
