#include "sim_board/servo/drive.h"

#include <algorithm>
#include <cmath>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/emergency.h"

namespace koboshi::sim {
namespace {

using canopen::AbortCode;
using canopen::NmtCommand;
namespace cia402 = canopen::cia402;
namespace error_register = canopen::error_register;

// From full speed to rest in 50 ms: well within what the motor can do.
constexpr double kStopTime_s = 0.05;
// Communication error, generic (CiA 301, table 26).
constexpr std::uint16_t kErrorCommunication = 0x8100;
// Excess temperature of the drive (CiA 402-2, table of error codes).
constexpr std::uint16_t kErrorTemperature = 0x4310;

std::optional<ScalarSensor> make_meter(const std::optional<ScalarSensorDescription>& description,
                                       const std::string& name, const ServoOptions& options) {
  if (!description) return std::nullopt;
  return ScalarSensor(*description, name, {.seed = options.seed, .scale = options.noise_scale});
}

DriveValues power_on_values(const JointDescription& joint) {
  DriveValues values;
  const ServoDescription& servo = joint.servo;
  const double stall_torque_Nm = servo.torque_constant_Nm_per_A * servo.supply_V / servo.resistance_ohm;
  values.rated_torque_mNm = static_cast<std::uint32_t>(std::lround(1000.0 * stall_torque_Nm));
  values.supply_mV = static_cast<std::uint32_t>(std::lround(1000.0 * servo.supply_V));
  values.quick_stop_deceleration =
      static_cast<std::uint32_t>(std::lround(joint.max_speed_rad_per_s / kStopTime_s / kRadPerPositionUnit));
  return values;
}

}  // namespace

Drive::Drive(const JointDescription& joint, Bus& bus, const ServoOptions& options)
    : joint_(joint),
      bus_(bus),
      handle_(bus.attach(*this, AcceptanceFilter::all(), kTransmitFifo)),
      servo_(joint, options),
      voltmeter_(make_meter(joint.servo.voltmeter, joint.name + ".voltmeter", options)),
      thermometer_(make_meter(joint.servo.thermometer, joint.name + ".thermometer", options)),
      description_(drive_node_description(joint.drive)),
      values_(power_on_values(joint)),
      node_(description_,
            {.node_id = joint.drive.node_id,
             .serial_number = joint.drive.serial_number,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), *this, *this) {
  bus_.power_off(handle_);
}

void Drive::power_on(std::uint64_t now_us) {
  powered_ = true;
  hanging_ = false;
  started_ = false;
  start_us_ = now_us + kBootTime_us;
  bus_.power_on(handle_);
}

void Drive::power_off() {
  powered_ = false;
  bus_.power_off(handle_);
}

void Drive::hang() {
  hanging_ = true;
  bus_.power_off(handle_);
}

void Drive::set_enable_line(bool high) {
  enable_line_ = high;
  if (!high && powered_ && !hanging_) state_.torque_off();
}

void Drive::update(const JointState& joint, std::uint64_t now_us) {
  now_us_ = now_us;
  servo_.sense(joint);
  measure();
  if (hanging_ && enable_line_ && powered_) return;
  if (powered_ && !hanging_) {
    if (!started_ && now_us >= start_us_) {
      started_ = true;
      node_.start(now_us);
    }
    if (started_) {
      node_.process(now_us);
      watch_sync();
      watch_temperature();
      finish_stop();
    }
  }
  if (makes_torque()) {
    servo_.drive(demand_.at(now_us));
  } else {
    servo_.release();
  }
}

void Drive::measure() {
  if (voltmeter_) voltmeter_->step(servo_.supply_V(), now_us_);
  if (thermometer_) thermometer_->step(winding_C(), now_us_);
  const double supply_V = voltmeter_ ? voltmeter_->reading() : servo_.supply_V();
  const double shown_C = thermometer_ ? thermometer_->reading() : winding_C();
  values_.supply_mV = static_cast<std::uint32_t>(std::lround(1000.0 * std::max(supply_V, 0.0)));
  values_.winding_dC = static_cast<std::int16_t>(std::lround(10.0 * shown_C));
}

// --- The bus
// ----------------------------------------------------------------------------------------------------

void Drive::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  now_us_ = time_us;
  if (started_) node_.on_frame(frame, time_us);
}

bool Drive::send(const hal::CanFrame& frame) { return bus_.queue(handle_, frame, now_us_); }

void Drive::on_reset(NmtCommand reset) {
  last_sync_us_.reset();
  if (reset != NmtCommand::kResetNode) return;
  values_ = power_on_values(joint_);
  state_ = DriveStateMachine();
  state_.initialised();
  show();
}

AbortCode Drive::on_write(canopen::ObjectAddress address, std::uint32_t value) {
  if (address.index == cia402::kControlword) obey(static_cast<std::uint16_t>(value));
  if (address.index == cia402::kModeOfOperation) values_.mode_display = static_cast<std::int8_t>(value);
  return AbortCode::kNone;
}

void Drive::on_sync(std::uint64_t now_us) {
  last_sync_us_ = now_us;
  if (node_.state() != canopen::NmtState::kOperational) return;
  obey(values_.controlword);
  follow_target();
  show();
}

void Drive::on_heartbeat(const canopen::HeartbeatEvent& event) {
  if (event.kind == canopen::HeartbeatEventKind::kLost) abort_connection(cia402::kErrorHeartbeatLost);
}

void Drive::on_state(canopen::NmtState state) {
  if (state != canopen::NmtState::kOperational && state_.makes_torque())
    abort_connection(kErrorCommunication);
}

void Drive::abort_connection(std::uint16_t error_code) {
  switch (values_.abort_connection_option) {
    case 1:
      return fault(error_code, error_register::kCommunication);
    case 2:
      return obey(cia402::kControlDisableVoltage);
    case 3:
      return obey(cia402::kControlQuickStop);
    default:
      return;
  }
}

void Drive::watch_sync() {
  canopen::ObjectValue period;
  if (!last_sync_us_ || !state_.makes_torque()) return;
  static_cast<void>(node_.read_object({0x1006, 0}, period));
  if (period.number() != 0 && now_us_ - *last_sync_us_ > kSyncTolerance * period.number()) {
    fault(cia402::kErrorSyncLost, error_register::kCommunication);
  }
}

void Drive::watch_temperature() {
  if (servo_.winding().too_hot()) fault(kErrorTemperature, error_register::kTemperature);
}

// --- The state machine
// ------------------------------------------------------------------------------------------

void Drive::obey(std::uint16_t controlword) {
  const auto before = state_.state();
  state_.command(controlword);
  if (!enable_line_) state_.torque_off();
  if (before == cia402::State::kFault && servo_.winding().too_hot())
    state_.fault();  // no reset before it cools
  const auto after = state_.state();
  if (before == after) return;
  if (after == cia402::State::kOperationEnabled) demand_.hold(servo_.position_units());
  if (after == cia402::State::kQuickStopActive) begin_stop();
  if (before == cia402::State::kFault) {
    node_.clear_error(values_.error_code);
    values_.error_code = 0;
  }
}

void Drive::fault(std::uint16_t error_code, std::uint8_t register_bits) {
  if (state_.state() == cia402::State::kFault || state_.state() == cia402::State::kFaultReactionActive)
    return;
  values_.error_code = error_code;
  state_.fault();
  begin_stop();
  show();
  node_.raise_error(error_code, register_bits);
}

void Drive::begin_stop() { demand_.stop(now_us_, values_.quick_stop_deceleration); }

void Drive::finish_stop() {
  const bool stopping = state_.state() == cia402::State::kQuickStopActive ||
                        state_.state() == cia402::State::kFaultReactionActive;
  if (!stopping || !demand_.stands(now_us_ - std::min(now_us_, kStandTime_us))) return;
  state_.stand_still();
  show();
}

void Drive::follow_target() {
  if (state_.state() != cia402::State::kOperationEnabled) return;
  const std::int32_t target =
      std::clamp(values_.target_position, values_.position_limit[0], values_.position_limit[1]);
  demand_.approach(target, now_us_, values_.interpolation_period * 1000u);
}

void Drive::show() {
  values_.statusword = static_cast<std::uint16_t>(cia402::statusword_of(state_.state()) | cia402::kRemote);
  if (state_.makes_torque()) values_.statusword |= cia402::kVoltageEnabled;
  if (state_.state() == cia402::State::kOperationEnabled) values_.statusword |= cia402::kFollowsCommand;
  if (!enable_line_) values_.statusword |= cia402::kTorqueOff;
  values_.position_actual = servo_.reported_units();
  const double permille = 1e6 * servo_.torque_Nm() / values_.rated_torque_mNm;
  values_.torque_actual_permille =
      static_cast<std::int16_t>(std::lround(std::clamp(permille, -32768.0, 32767.0)));
}

}  // namespace koboshi::sim
