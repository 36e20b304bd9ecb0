#include "sim_board/drive/drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/emergency.h"
#include "sim_board/drive/motion_limits.h"

namespace koboshi::sim_board {
namespace {

using canopen::AbortCode;
using canopen::NmtCommand;
namespace cia402 = canopen::cia402;
namespace error_register = canopen::error_register;

// From full speed to rest in 50 ms: well within what the motor can do.
constexpr double kStopTime_s = 0.05;
// A profile that nobody has changed gets there in five times that: a motion that is easy on the gears.
constexpr double kProfileTime_s = 0.25;
constexpr canopen::ObjectAddress kTarget{cia402::kTargetPosition, 0};
// Communication error, generic (CiA 301, table 26).
constexpr std::uint16_t kErrorCommunication = 0x8100;

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
  values.rated_current_mA =
      static_cast<std::uint32_t>(std::lround(1000.0 * servo.supply_V / servo.resistance_ohm));
  values.supply_mV = static_cast<std::uint32_t>(std::lround(1000.0 * servo.supply_V));
  const double highest_speed = joint.max_speed_rad_per_s / kRadPerPositionUnit;
  values.profile_velocity = static_cast<std::uint32_t>(std::lround(highest_speed));
  values.profile_acceleration = static_cast<std::uint32_t>(std::lround(highest_speed / kProfileTime_s));
  values.profile_deceleration = values.profile_acceleration;
  values.quick_stop_deceleration =
      static_cast<std::uint32_t>(std::lround(joint.max_speed_rad_per_s / kStopTime_s / kRadPerPositionUnit));
  return values;
}

}  // namespace

Drive::Drive(const JointDescription& joint, Bus& bus, const ServoOptions& options)
    : joint_(joint),
      bus_(bus),
      handle_(bus.attach(*this, AcceptanceFilter(), kTransmitFifo)),
      servo_(joint, options),
      voltmeter_(make_meter(joint.servo.voltmeter, joint.name + ".voltmeter", options)),
      thermometer_(make_meter(joint.servo.thermometer, joint.name + ".thermometer", options)),
      monitor_(joint.servo),
      description_(drive_node_description(joint.drive)),
      values_(power_on_values(joint)),
      services_({description_.vendor_id, description_.product_code, description_.revision_number,
                 joint.drive.serial_number},
                *this),
      node_(description_,
            {.node_id = joint.drive.node_id,
             .serial_number = joint.drive.serial_number,
             .values = std::as_writable_bytes(std::span(&values_, 1)),
             .services = &services_},
            memory_.buffers(), *this, *this) {
  bus_.power_off(handle_);
}

void Drive::power_on(std::uint64_t now_us) {
  powered_ = true;
  hanging_ = false;
  started_ = false;
  start_us_ = now_us + kBootTime_us;
  storage_.power_on();
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

void Drive::update(const JointState& joint, std::uint64_t now_us) {
  now_us_ = now_us;
  servo_.sense(joint);
  measure();
  if (hanging_ && enable_line_ && powered_) return;
  if (powered_ && !hanging_) {
    if (!started_ && now_us >= start_us_) {
      started_ = true;
      services_.start(storage_.node_id(joint_.drive.node_id));
      node_.start(now_us);
      filter_.set(bus_, handle_, node_, services_);
    }
    if (started_) run_loop();
  }
  if (makes_torque() && values_.max_torque_permille > 0) {
    servo_.limit_torque(values_.max_torque_permille);
    servo_.scale_gain(values_.position_gain_permille);
    servo_.drive(demand_.at(now_us) - home_units_);
  } else {
    servo_.release();
  }
}

void Drive::archive(StateArchive& archive) {
  archive(servo_, voltmeter_, thermometer_, state_, leaving_by_, demand_, target_given_, target_limited_,
          profile_, homing_, home_units_, watch_, velocity_, shown_current_A_, monitor_, description_,
          values_, storage_, powered_, hanging_, started_, enable_line_, start_us_, now_us_, last_sync_us_,
          bus_off_);
  archive.in_place(memory_, services_, node_);
  if (!archive.writes()) filter_.set(bus_, handle_, node_, services_);
}

void Drive::run_loop() {
  watch_bus();
  storage_.process();
  services_.process(node_);
  node_.process(now_us_);
  change_mode();
  if (values_.mode_display == cia402::kProfilePosition && follows_targets()) step_profile();
  if (values_.mode_display == cia402::kHoming && follows_targets() &&
      homing_.step(values_.controlword, !servo_.encoder_broken())) {
    make_home();
  }
  watch_sync();
  watch_servo();
  watch_position();
  finish_stop();
  if (!limits_contradict(values_)) report_parameters(false);
  show_torque();
  show();
  if (limited() && values_.limited_ms < std::numeric_limits<std::uint32_t>::max()) ++values_.limited_ms;
}

void Drive::measure() {
  velocity_.step(servo_.position_units());
  if (!voltmeter_ || voltmeter_->step(servo_.supply_V(), now_us_)) {
    const double supply_V = voltmeter_ ? voltmeter_->reading() : servo_.supply_V();
    values_.supply_mV = static_cast<std::uint32_t>(std::lround(1000.0 * std::max(supply_V, 0.0)));
  }
  if (!thermometer_ || thermometer_->step(winding_C(), now_us_)) {
    const double shown_C = thermometer_ ? thermometer_->reading() : winding_C();
    values_.winding_dC = static_cast<std::int16_t>(std::lround(10.0 * shown_C));
  }
  if (const auto time = services_.time_of_day(now_us_)) {
    values_.time_ms = time->ms;
    values_.time_days = time->days;
  }
}

// --- The bus
// ----------------------------------------------------------------------------------------------------

void Drive::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  if (!started_) return;
  now_us_ = time_us;
  if (!services_.on_frame(node_, frame, time_us)) node_.on_frame(frame, time_us);
  filter_.update(bus_, handle_, node_, services_);
}

bool Drive::send(const hal::CanFrame& frame) { return bus_.queue(handle_, frame, now_us_); }

void Drive::on_reset(NmtCommand reset) {
  last_sync_us_.reset();
  if (reset == NmtCommand::kResetNode) {
    forget_motion();
  } else {
    demand_.await_stream();
    forget_target();
  }
  storage_.load(reset);
  show();
}

void Drive::forget_motion() {
  const DriveValues before = std::exchange(values_, power_on_values(joint_));
  values_.supply_mV = before.supply_mV;
  values_.winding_dC = before.winding_dC;
  compute_torque();
  home_units_ = 0;
  state_ = DriveStateMachine();
  state_.initialised();
  leaving_by_.reset();
  demand_.hold(position_units());
  restart_motion(0);
  homing_.restart(0);
  watch_.restart();
}

AbortCode Drive::on_write(canopen::ObjectAddress address, std::uint32_t value) {
  if (address.index == cia402::kControlword) {
    obey(static_cast<std::uint16_t>(value));
    show();
  }
  if (address == kTarget) target_given_ = true;
  return AbortCode::kNone;
}

// Whichever it was, it may carry a controlword, and it has waited for the SYNC already if it had to. A target
// beside the controlword is for the operation that the controlword enables.
bool Drive::on_rpdo(std::size_t number) {
  const std::int32_t target = values_.target_position;
  obey(values_.controlword);
  if (node_.receives(number, kTarget)) give_target(target);
  show();
  return true;
}

void Drive::on_sync(std::uint64_t now_us) {
  last_sync_us_ = now_us;
  if (node_.state() == canopen::NmtState::kOperational) follow_target();
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

// Bus-off is one of the events of 0x6007 (CiA 402-2). Its message waits for the recovery.
void Drive::watch_bus() {
  const hal::CanStatus status = bus_.status(handle_);
  node_.on_can_status(status, now_us_);
  if (bus_off_.step(bus_, handle_, status, now_us_)) abort_connection(canopen::error_code::kBusOffRecovered);
}

void Drive::watch_sync() {
  if (!last_sync_us_ || !state_.makes_torque()) return;
  const std::uint64_t period_us = node_.sync_period_us();
  if (period_us != 0 && now_us_ - *last_sync_us_ > kSyncTolerance * period_us) {
    fault(cia402::kErrorSyncLost, error_register::kCommunication);
  }
}

void Drive::watch_servo() {
  if (const auto found = monitor_.step(servo_, makes_torque(), now_us_))
    fault(found->error_code, found->register_bits);
  // Even in the middle of a ramp.
  if (servo_.encoder_broken() && state_.makes_torque()) state_.torque_off();
}

}  // namespace koboshi::sim_board
