#include "firmware/app/controller.h"

#include <algorithm>

#include "firmware/canopen/emergency.h"
#include "firmware/drive/configuration.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::app {

using namespace fixed::literals;
using canopen::AbortCode;
using canopen::NmtCommand;
using canopen::NmtState;
namespace cia402 = canopen::cia402;

namespace {

constexpr std::uint8_t kCommand = 1;  // sub-indices of kRequestObject
// An encoder may stand this far outside the joint's limits: backlash and offset of a robot that leans on its
// stops.
constexpr fixed::Angle kEncoderMargin = 2.0_deg;
constexpr std::int32_t kMinRamp_us = 500'000;
// How long the drives have for their quick stop before the line falls.
constexpr std::uint64_t kQuickStop_us = 300'000;
constexpr std::uint64_t kBusTimeout_us = 200'000;
// Emergency error code of the controller itself: device specific (CiA 301, table 26), with state and reason
// beside it.
constexpr std::uint16_t kErrorBehaviour = 0xFF00;

std::int16_t narrow(std::int32_t raw, int shift) {
  return fixed::saturate<std::int16_t>(fixed::shift_rounded(raw, shift));
}

// False, and a robot without joints, when storage holds no valid model.
bool load(const Catalogue& catalogue, robot::RobotModel& model) {
  const auto image = catalogue.find(ItemKind::kRobotModel, 0);
  const bool valid = robot::load_model(image, model) == robot::ModelStatus::kOk;
  if (!valid) model.joint_count = 0;
  return valid;
}

}  // namespace

Controller::Controller(const hal::Board& board)
    : board_(board),
      catalogue_(board.storage.contents()),
      model_valid_(load(catalogue_, model_)),
      sink_(board.can),
      node_(kControllerNode,
            {.node_id = drive::kControllerNodeId,
             .serial_number = 1,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), sink_, *this),
      drives_(model_, node_.sink(), values_.drives),
      inertial_(model_),
      interpreter_(model_) {}

void Controller::service(std::uint64_t now_us) {
  now_us_ = now_us;
  board_.watchdog.kick(now_us);
  if (!started_) start(now_us);
  receive(now_us);
  node_.process(now_us);
  drives_.process(now_us);
  read_sensors(now_us);
  watch_bus();
}

void Controller::tick(std::uint64_t now_us) {
  drives_.tick(now_us);
  if (drives_.trouble()) fail(Reason::kDriveTrouble);
  watch_sensors(now_us);
  run_state(now_us);
  publish_telemetry();
  publish(now_us);
}

void Controller::start(std::uint64_t now_us) {
  started_ = true;
  values_.diagnosis.model_id = model_.id;
  load_motions();
  node_.start(now_us);
  enter(State::kBoot, Reason::kNone);
  if (!model_valid_) fail(Reason::kModelInvalid);
}

void Controller::load_motions() {
  for (std::uint16_t number = 0; number < kMaxMotions; ++number) {
    motion::Motion motion;
    const auto image = catalogue_.find(ItemKind::kMotion, number);
    if (motion::Motion::open(image, model_, motion).ok()) {
      values_.diagnosis.motions |= 1u << number;
    }
  }
}

void Controller::receive(std::uint64_t now_us) {
  hal::CanFrame frame;
  // Bounded, so that a babbling bus cannot hold the controller in here.
  for (std::size_t i = 0; i < 64 && board_.can.receive(frame); ++i) {
    node_.on_frame(frame, now_us);
    drives_.on_frame(frame);
  }
}

void Controller::read_sensors(std::uint64_t now_us) {
  hal::ImuSample imu;
  for (std::size_t i = 0; i < 16 && board_.imu.read(imu); ++i) inertial_.add(imu, now_us);
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    hal::AnkleSample sample;
    if (!board_.ankles.read(side, sample)) continue;
    const auto foot = static_cast<std::size_t>(side);
    ankle_us_[foot] = now_us;
    std::ranges::copy(sample.force_raw, values_.ankles[foot]);
    std::ranges::copy(sample.torque_raw, values_.ankles[foot] + 3);
  }
}

void Controller::watch_bus() {
  const hal::CanStatus status = board_.can.status();
  values_.diagnosis.receive_overruns = status.receive_overruns;
  values_.diagnosis.imu_overruns = board_.imu.overruns();
  values_.diagnosis.frames_lost = node_.lost_frames();
  if (status.state == hal::CanErrorState::kBusOff) {
    board_.can.recover();
    fail(Reason::kBusOff);
  }
  // A lone node becomes error-passive and stays so: nobody acknowledges what it says.
  if (status.state == hal::CanErrorState::kErrorPassive && now_us_ - started_us_ >= kBusTimeout_us) {
    fail(Reason::kNoAcknowledge);
  }
}

void Controller::watch_sensors(std::uint64_t now_us) {
  if (now_us - started_us_ < kSensorStart_us) return;
  if (!inertial_.alive(now_us, kSensorTimeout_us)) fail(Reason::kImuSilent);
  for (const std::uint64_t last_us : ankle_us_) {
    if (now_us - last_us > kSensorTimeout_us) fail(Reason::kAnkleSilent);
  }
}

// --- Commands
// ---------------------------------------------------------------------------------------------------

AbortCode Controller::on_write(canopen::ObjectAddress address, std::uint32_t value) {
  if (address != canopen::ObjectAddress{kRequestObject, kCommand}) return AbortCode::kNone;
  const Reason refusal = obey(static_cast<Command>(value), values_.request.argument);
  if (refusal == Reason::kNone) return AbortCode::kNone;
  return refusal == Reason::kUnknownCommand ? AbortCode::kInvalidValue : AbortCode::kDeviceState;
}

void Controller::on_rpdo(std::size_t number) {
  if (number == kCommandRpdo) static_cast<void>(obey(values_.request.command, values_.request.argument));
}

Reason Controller::obey(Command command, std::int16_t argument) {
  Reason refusal = Reason::kUnknownCommand;
  switch (command) {
    case Command::kNone:
      refusal = Reason::kNone;
      break;
    case Command::kEnable:
      refusal = enable();
      break;
    case Command::kLimp:
      refusal = obey_event(Event::kLimp);
      break;
    case Command::kPlay:
      refusal = play(argument);
      break;
    case Command::kStop:
      interpreter_.stop();
      refusal = Reason::kNone;
      break;
    case Command::kEmergencyStop:
      refusal = obey_event(Event::kEmergencyStop);
      break;
    case Command::kReset:
      refusal = obey_event(Event::kReset);
      break;
  }
  if (refusal != Reason::kNone) values_.behaviour.reason = refusal;
  return refusal;
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
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if (!drives_.within_limits(joint, kEncoderMargin)) return Reason::kEncoderBeyondLimits;
    const std::uint32_t supply_mV = drives_.supply_mV(joint);
    if (supply_mV < parameters.supply_min_mV || supply_mV > parameters.supply_max_mV) {
      return Reason::kSupplyOutOfRange;
    }
  }
  const auto& a = inertial_.accelerations();
  const fixed::Acceleration magnitude = fixed::hypotenuse(a.x, a.y, a.z);
  const bool plausible = magnitude > 4.9_m_per_s2 && magnitude < 14.7_m_per_s2;
  return plausible ? Reason::kNone : Reason::kImuImplausible;
}

Reason Controller::play(std::int16_t number) {
  if (values_.behaviour.state != State::kStanding) return Reason::kNotInThisState;
  motion::Motion motion;
  if (number < 0 || number >= static_cast<std::int16_t>(kMaxMotions)) return Reason::kNoSuchMotion;
  const auto image = catalogue_.find(ItemKind::kMotion, static_cast<std::uint16_t>(number));
  if (!motion::Motion::open(image, model_, motion).ok()) return Reason::kNoSuchMotion;
  values_.behaviour.motion = static_cast<std::uint8_t>(number);
  interpreter_.start(motion, {targets_.data(), model_.joint_count});
  return obey_event(Event::kPlay);
}

// --- State machine
// ----------------------------------------------------------------------------------------------

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
  board_.drive_enable.set(makes_torque(state) || state == State::kFault);
  switch (state) {
    case State::kBoot:
      started_us_ = now_us_;
      values_.behaviour.trouble = drive::Trouble::kNone;
      node_.clear_error(kErrorBehaviour);
      if (model_valid_) drives_.boot();
      break;
    case State::kLimp:
    case State::kEmergencyStop:
      interpreter_.abort();
      drives_.set_goal(drive::Goal::kTorqueOff, now_us_);
      break;
    case State::kEnabling:
      drives_.set_goal(drive::Goal::kEnabled, now_us_);
      break;
    case State::kSoftStart:
      begin_soft_start();
      break;
    case State::kStanding:
    case State::kMotion:
      break;
    case State::kFault:
      interpreter_.abort();
      fault_us_ = now_us_;
      drives_.set_goal(drive::Goal::kQuickStop, now_us_);
      break;
  }
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
    case State::kFault:
      return run_fault(now_us);
    case State::kLimp:
    case State::kEmergencyStop:
      return follow_actual();
    case State::kStanding:
      return;
  }
}

void Controller::run_boot(std::uint64_t now_us) {
  if (node_.state() == NmtState::kPreOperational && drives_.configured()) {
    node_.command(NmtCommand::kStart, now_us);
  }
  if (!drives_.booted() || !inertial_.alive(now_us, kSensorTimeout_us)) return;
  follow_actual();
  handle(Event::kReady, Reason::kProgress);
}

void Controller::run_enabling() {
  follow_actual();
  if (drives_.all_in(cia402::State::kOperationEnabled)) handle(Event::kEnabled, Reason::kProgress);
}

void Controller::begin_soft_start() {
  ramp_from_ = targets_;
  ramp_to_ = targets_;
  motion::Motion standing;
  const auto image = catalogue_.find(ItemKind::kMotion, 0);
  const bool known = motion::Motion::open(image, model_, standing).ok();
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

void Controller::run_motion() {
  interpreter_.advance(kTick_us);
  std::ranges::copy(interpreter_.targets(), targets_.begin());
  if (!interpreter_.running()) handle(Event::kEnded, Reason::kProgress);
}

void Controller::run_fault(std::uint64_t now_us) {
  if (drives_.all_limp() || now_us - fault_us_ >= kQuickStop_us) board_.drive_enable.set(false);
}

void Controller::follow_actual() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) targets_[joint] = drives_.angle(joint);
}

// --- Output
// -----------------------------------------------------------------------------------------------------

void Controller::publish(std::uint64_t now_us) {
  if (node_.state() != NmtState::kOperational) return;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    drives_.set_target(joint, robot::clamp_to_limits(model_.joints[joint], targets_[joint]));
    node_.trigger_tpdo(kFirstDriveTpdo + joint, now_us);
  }
  node_.send_sync(now_us);
}

void Controller::publish_telemetry() {
  auto& attitude = values_.attitude;
  attitude.roll = narrow(inertial_.roll().raw(), 16);
  attitude.pitch = narrow(inertial_.pitch().raw(), 16);
  const auto& rates = inertial_.rates();
  const auto& accelerations = inertial_.accelerations();
  const fixed::AngularRate rate[] = {rates.x, rates.y, rates.z};
  const fixed::Acceleration acceleration[] = {accelerations.x, accelerations.y, accelerations.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    attitude.rate[axis] = narrow(rate[axis].raw(), 12);
    attitude.acceleration[axis] = narrow(acceleration[axis].raw(), 12);
  }
}

void Controller::on_reset(NmtCommand) {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const std::uint8_t node_id = model_.joints[joint].drive.node_id;
    const auto subindex = static_cast<std::uint8_t>(joint + 1);
    const std::uint32_t consumer = (std::uint32_t{node_id} << 16) | drive::kDriveHeartbeatLost_ms;
    // The memory was made for kMaxJoints and the model is valid, so none of these can fail.
    static_cast<void>(node_.configure_rpdo(kFirstDriveRpdo + joint, drive_rpdo(joint, node_id)));
    static_cast<void>(node_.configure_tpdo(kFirstDriveTpdo + joint, drive_tpdo(joint, node_id)));
    static_cast<void>(node_.write_object({0x1016, subindex}, consumer, 4));
  }
}

}  // namespace koboshi::app
