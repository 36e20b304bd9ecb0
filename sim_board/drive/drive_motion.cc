#include <algorithm>
#include <cmath>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/emergency.h"
#include "sim_board/drive/drive.h"
#include "sim_board/drive/motion_limits.h"
#include "sim_board/servo/position_unit.h"

// How a drive moves its shaft: states, modes of operation, stops, and the objects that show them.
namespace koboshi::sim_board {

namespace cia402 = canopen::cia402;

namespace {

// `rated` in thousandths of the value's unit.
std::int16_t share_permille(double value, std::uint32_t rated) {
  return static_cast<std::int16_t>(nearest(std::clamp(1e6 * value / rated, -32768.0, 32767.0)));
}

}  // namespace

void Drive::obey(std::uint16_t controlword) {
  if (slows_down_before(controlword)) return;
  const auto before = state_.state();
  state_.command(controlword, cia402::stays_in_quick_stop(values_.quick_stop_option));
  if (!enable_line_) state_.torque_off();
  if (before == cia402::State::kFault && monitor_.forbids_reset(servo_)) state_.fault();
  check_parameters(before);
  const auto after = state_.state();
  if (before == after) return;
  if (after == cia402::State::kOperationEnabled) {
    // Out of a quick stop the demand goes on as it is, on its ramp or at rest.
    if (before != cia402::State::kQuickStopActive) demand_.hold(position_units());
    restart_motion(controlword);
    homing_.restart(controlword);
  }
  if (after == cia402::State::kQuickStopActive) begin_stop(values_.quick_stop_option);
  if (before == cia402::State::kFault) {
    node_.clear_error(values_.error_code);
    values_.error_code = 0;
  }
}

// Whichever transition it would be: none leads to operation enabled while 0x607D leaves no position to go to.
// The refusal is an error until the controller asks for something else, or the limits agree again.
void Drive::check_parameters(cia402::State before) {
  const bool enabled = state_.state() == cia402::State::kOperationEnabled && before != state_.state();
  const bool refused = enabled && limits_contradict(values_);
  if (refused) state_.refuse(before);
  report_parameters(refused);
}

void Drive::report_parameters(bool contradict) {
  if (contradict) {
    values_.error_code = cia402::kErrorParameter;
    node_.raise_error(cia402::kErrorParameter, canopen::error_register::kProfile);
  } else {
    if (values_.error_code == cia402::kErrorParameter) values_.error_code = 0;
    node_.clear_error(cia402::kErrorParameter);
  }
}

// Forgets what was asked for: the demand is where it is, and nothing moves before the next target.
void Drive::restart_motion(std::uint16_t controlword) {
  profile_.restart(demand_.at(now_us_), controlword);
  demand_.await_stream();
  forget_target();
}

// A target that was given before the last reset, enabling, change of the mode, or homing may lie anywhere.
void Drive::forget_target() {
  values_.target_position = makes_torque() ? demand_.at(now_us_) : position_units();
  target_given_ = false;
  target_limited_ = false;
}

// Transitions 5 and 8 wait for a ramp where 0x605C and 0x605B say so; any other command ends the wait.
bool Drive::slows_down_before(std::uint16_t controlword) {
  using canopen::cia402::Command;
  const Command command = cia402::command_of(controlword);
  const std::int16_t option = command == Command::kShutdown   ? values_.shutdown_option
                              : command == Command::kSwitchOn ? values_.disable_operation_option
                                                              : cia402::kDisableDrive;
  if (state_.state() != cia402::State::kOperationEnabled || option == cia402::kDisableDrive) {
    if (leaving_by_) restart_motion(controlword);
    leaving_by_.reset();
    return false;
  }
  if (!leaving_by_) begin_stop(option);
  leaving_by_ = controlword;
  return true;
}

void Drive::fault(std::uint16_t error_code, std::uint8_t register_bits) {
  if (state_.state() == cia402::State::kFault || state_.state() == cia402::State::kFaultReactionActive)
    return;
  values_.error_code = error_code;
  leaving_by_.reset();
  state_.fault();
  begin_stop(servo_.encoder_broken() ? cia402::kDisableDrive : values_.fault_reaction_option);
  show();
  node_.raise_error(error_code, register_bits);
}

void Drive::begin_stop(std::int16_t option) {
  if (option == cia402::kDisableDrive) return state_.torque_off();
  brake(deceleration(option));
}

// Where the error is so large that the position loop gives the full voltage, the demand is far ahead of a
// shaft that is as fast as it can be: the ramp then begins at the shaft.
void Drive::brake(double deceleration_units_per_s2) {
  const double lead_units = joint_.servo.full_voltage_error_rad / kRadPerPositionUnit;
  const double ahead_units = static_cast<double>(demand_.at(now_us_)) - position_units();
  if (std::abs(ahead_units) > lead_units) {
    demand_.continue_from(position_units() + std::copysign(lead_units, ahead_units), velocity_.units_per_s(),
                          now_us_);
  }
  demand_.stop(now_us_, deceleration_units_per_s2, position_range(values_),
               joint_.max_speed_rad_per_s / kRadPerPositionUnit);
}

double Drive::deceleration(std::int16_t option) const {
  const bool stays = cia402::stays_in_quick_stop(option);
  switch (stays ? option - cia402::kStayInQuickStop : option) {
    case cia402::kStopOnSlowDownRamp:
      return profile_limits(values_).deceleration_units_per_s2;
    case cia402::kStopOnQuickStopRamp:
      return values_.quick_stop_deceleration;
    default:
      return kAtOnce;
  }
}

void Drive::finish_stop() {
  if (state_.state() != cia402::State::kOperationEnabled) leaving_by_.reset();
  const bool stopping = leaving_by_ || state_.state() == cia402::State::kQuickStopActive ||
                        state_.state() == cia402::State::kFaultReactionActive;
  if (!stopping || !demand_.stands(now_us_ - std::min(now_us_, kStandTime_us))) return;
  const bool stays = state_.state() == cia402::State::kQuickStopActive &&
                     cia402::stays_in_quick_stop(values_.quick_stop_option);
  if (stays) return;
  if (leaving_by_) {
    state_.command(*leaving_by_);
    leaving_by_.reset();
  } else {
    state_.stand_still();
  }
  show();
}

void Drive::follow_target() {
  if (!follows_targets()) return;
  if (values_.mode_display != cia402::kCyclicSynchronousPosition || !target_given_) return;
  const std::int32_t target = within_limits(values_, values_.target_position, demand_.at(now_us_));
  const bool reached =
      demand_.follow(target, now_us_, values_.interpolation_period * 1000u, cyclic_limits(values_));
  target_limited_ = !reached || target != values_.target_position;
}

void Drive::step_profile() {
  const bool halted = profile_.halted();
  profile_.step(values_, target_given_, now_us_, demand_);
  if (profile_.halted() && !halted && !demand_.stands(now_us_)) brake(deceleration(values_.halt_option));
}

// A drive in operation changes its mode only at rest, so that no motion ends in a jerk.
void Drive::change_mode() {
  if (values_.mode == values_.mode_display) return;
  if (state_.makes_torque() && !demand_.at_rest(now_us_)) return;
  values_.mode_display = values_.mode;
  restart_motion(values_.controlword);
  homing_.restart(values_.controlword);
}

// The shaft stays where it is, and all that the bus counts goes on from the home offset.
void Drive::make_home() {
  const std::int32_t shift = values_.home_offset - position_units();
  home_units_ += shift;
  demand_.hold(demand_.at(now_us_) + shift);
  restart_motion(values_.controlword);
}

// A shaft that turns freely follows nothing, and is not to blame for it.
void Drive::watch_position() {
  if (!makes_torque() || values_.max_torque_permille == 0) return watch_.restart();
  const bool arrived = profile_.halted() ? demand_.stands(now_us_) : profile_.arrived();
  const std::int32_t target = profile_.halted() ? demand_.at(now_us_) : profile_.target();
  watch_.step(values_, demand_.at(now_us_), position_units(), target, arrived, now_us_);
  if (watch_.following_fault() && state_.state() == cia402::State::kOperationEnabled)
    fault(cia402::kErrorFollowing, canopen::error_register::kProfile);
}

bool Drive::limited() const {
  if (makes_torque() && demand_.steepened(now_us_)) return true;
  if (!follows_targets()) return false;
  if (values_.mode_display == cia402::kCyclicSynchronousPosition) return target_limited_;
  return values_.mode_display == cia402::kProfilePosition && profile_.limited();
}

std::uint16_t Drive::mode_bits() const {
  if (!follows_targets()) return 0;
  if (values_.mode_display == cia402::kCyclicSynchronousPosition) return cia402::kFollowsCommand;
  if (values_.mode_display == cia402::kHoming) return homing_.bits();
  if (values_.mode_display != cia402::kProfilePosition) return 0;
  return static_cast<std::uint16_t>((watch_.target_reached() ? cia402::kTargetReached : 0u) |
                                    (profile_.acknowledges() ? cia402::kSetPointAcknowledge : 0u));
}

void Drive::show() {
  values_.statusword = static_cast<std::uint16_t>(cia402::statusword_of(state_.state()) | cia402::kRemote);
  if (monitor_.supplied(servo_)) values_.statusword |= cia402::kVoltageEnabled;
  values_.statusword |= mode_bits();
  if (limited()) values_.statusword |= cia402::kInternalLimit;
  if (!enable_line_) values_.statusword |= cia402::kTorqueOff;
  if (watch_.following_fault()) values_.statusword |= cia402::kFollowingError;
  values_.following_error = watch_.following_error();
  values_.position_demand = makes_torque() ? demand_.at(now_us_) : position_units();
  values_.position_actual = servo_.reported_units() + home_units_;
  values_.velocity_actual = velocity_.units_per_s();
}

void Drive::compute_torque() {
  shown_current_A_ = servo_.current_A();
  values_.torque_actual_permille = share_permille(servo_.torque_Nm(), values_.rated_torque_mNm);
  values_.current_actual_permille = share_permille(servo_.current_A(), values_.rated_current_mA);
}

}  // namespace koboshi::sim_board
