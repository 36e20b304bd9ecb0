#include "firmware/app/policy_control.h"

#include "firmware/canopen/emergency.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {
namespace {

// Emergency error code of the controller: device specific (CiA 301, table 26). Cause and number follow in the
// manufacturer's field.
constexpr std::uint16_t kErrorPolicyStopped = 0xFF02;

}  // namespace

void PolicyControl::run(const behaviour::Behaviour& behaviour, const estimation::RobotState& robot,
                        std::span<const fixed::Angle> angles) {
  if (slot_.changes() != changes_) residual_.reset();  // the offsets are those of other joints
  changes_ = slot_.changes();
  const policy::Policy* const policy = slot_.open();
  const bool enabled = values_.policy.enabled != 0;
  if (enabled && policy != nullptr && behaviour.state() == behaviour::State::kWalking) {
    walk(*policy, behaviour, robot, angles);
  } else {
    rest(policy, behaviour::kTorque.contains(behaviour.state()));
  }
  in_use_ = enabled || residual_.active();
}

void PolicyControl::walk(const policy::Policy& policy, const behaviour::Behaviour& behaviour,
                         const estimation::RobotState& robot, std::span<const fixed::Angle> angles) {
  auto& shown = values_.policy;
  if (!walks_) shown.cause = policy::Cause::kNone;
  walks_ = true;
  const behaviour::Decision& decision = behaviour.decision();
  residual_.advance(policy, {.robot = robot,
                             .angles = angles,
                             .targets = {decision.targets.data(), model_.joint_count},
                             .planned_pitch = decision.planned_pitch,
                             .velocity = behaviour.velocity(),
                             .phase = behaviour.walk_phase(),
                             .swing = decision.swing});
  if (residual_.cause() != policy::Cause::kNone && !stopped_) report_stop();
  shown.state = stopped_ ? PolicyState::kStopped : PolicyState::kActive;
}

void PolicyControl::report_stop() {
  auto& shown = values_.policy;
  stopped_ = true;
  shown.cause = residual_.cause();
  shown.cause_number = residual_.cause_index();
  shown.stops = fixed::add_saturated(shown.stops, std::uint16_t{1});
  node_.raise_error(kErrorPolicyStopped, canopen::error_register::kManufacturer,
                    {static_cast<std::uint8_t>(shown.cause), shown.cause_number});
}

void PolicyControl::rest(const policy::Policy* policy, bool has_torque) {
  walks_ = false;
  if (stopped_) node_.clear_error(kErrorPolicyStopped);
  stopped_ = false;
  if (policy != nullptr && has_torque) {
    residual_.retreat(*policy);
  } else {
    residual_.reset();
  }
  values_.policy.state = resting_state(policy);
}

PolicyState PolicyControl::resting_state(const policy::Policy* policy) const {
  if (values_.policy.enabled == 0) return PolicyState::kOff;
  if (policy != nullptr) return PolicyState::kReady;
  return slot_.image().empty() ? PolicyState::kMissing : PolicyState::kRefused;
}

}  // namespace koboshi::app
