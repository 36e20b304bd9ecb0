// What the controller sends in each cycle.

#include "firmware/app/controller.h"
#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {
namespace {

std::int16_t narrow(std::int32_t raw, int shift) {
  return fixed::saturate<std::int16_t>(fixed::shift_rounded(raw, shift));
}

}  // namespace

void Controller::publish(std::uint64_t now_us) {
  if (node_.state() != canopen::NmtState::kOperational) return;
  if (drives_.configured()) command_drives(now_us);
  node_.send_sync(now_us);
}

void Controller::command_drives(std::uint64_t now_us) {
  drives_.command();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    drives_.set_target(joint, robot::clamp_to_limits(model_.joints[joint], targets_[joint]));
    node_.trigger_tpdo(kFirstDriveTpdo + joint, now_us);
  }
}

void Controller::publish_telemetry() {
  auto& attitude = values_.attitude;
  attitude.roll = narrow(inertial_.roll().raw(), 16);
  attitude.pitch = narrow(inertial_.pitch().raw(), 16);
  const auto rates = inertial_.rates();
  const auto accelerations = inertial_.accelerations();
  const fixed::AngularRate rate[] = {rates.x, rates.y, rates.z};
  const fixed::Acceleration acceleration[] = {accelerations.x, accelerations.y, accelerations.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    attitude.rate[axis] = narrow(rate[axis].raw(), 12);
    attitude.acceleration[axis] = narrow(acceleration[axis].raw(), 12);
  }
}

}  // namespace koboshi::app
