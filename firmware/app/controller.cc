#include "firmware/app/controller.h"

#include <algorithm>

#include "firmware/drive/configuration.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {

using canopen::NmtCommand;

namespace {

constexpr std::uint64_t kBusTimeout_us = 200'000;

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
      items_(board.storage),
      model_valid_(load(catalogue_, model_)),
      R_BI_(model_.R_BI),
      sink_(board.can),
      node_(kControllerNode,
            {.node_id = drive::kControllerNodeId,
             .serial_number = 1,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), sink_, *this),
      parameters_(items_, static_cast<std::uint16_t>(ItemKind::kParameters), node_),
      motion_index_(values_.diagnosis.motions),
      motion_transfer_(items_, model_, motion_index_),
      drives_(model_, node_.sink(), values_.drives),
      sensor_nodes_(board.sensor_nodes, node_.sink()),
      inertial_(model_),
      feedback_(model_),
      foot_sensors_{balance::FootSensor(model_, hal::Side::kLeft),
                    balance::FootSensor(model_, hal::Side::kRight)},
      interpreter_(model_, attitude_.up_B()),
      walker_(model_) {}

void Controller::service(std::uint64_t now_us) {
  now_us_ = now_us;
  board_.watchdog.kick(now_us);
  if (!started_) start(now_us);
  receive(now_us);
  node_.process(now_us);
  drives_.process(now_us, starting());
  if (!drives_.resetting())
    sensor_nodes_.process(is_operational() && (values_.nmt_startup & kNoSlaveStart) == 0);
  items_.process();
  parameters_.process();
  read_inertial_unit(now_us);
}

void Controller::tick(std::uint64_t now_us) {
  watch_network();
  drives_.observe(now_us);
  if (drives_.trouble()) fail(Reason::kDriveTrouble);
  watch_bus();
  watch_impostors();
  read_ankles(now_us);
  watch_sensors(now_us);
  watch_battery();
  estimate();
  watch_for_falls();
  run_state(now_us);
  publish_telemetry();
  publish(now_us);
}

void Controller::start(std::uint64_t now_us) {
  started_ = true;
  values_.diagnosis.model_id = model_.id;
  load_motions();
  node_.start(now_us);
}

void Controller::load_motions() {
  for (std::uint16_t number = 0; number < kMaxMotions; ++number) {
    motion::Motion motion;
    if (open_motion(number, motion)) motion_index_.add(number, motion);
  }
}

std::span<const std::byte> Controller::motion_image(std::uint16_t number) const {
  const auto stored = items_.find(ItemKind::kMotion, number);
  return stored.empty() ? catalogue_.find(ItemKind::kMotion, number) : stored;
}

bool Controller::open_motion(std::uint16_t number, motion::Motion& motion) const {
  // One that was stored for another model makes way for the factory's.
  return motion::Motion::open(items_.find(ItemKind::kMotion, number), model_, motion).ok() ||
         motion::Motion::open(catalogue_.find(ItemKind::kMotion, number), model_, motion).ok();
}

void Controller::forget_commands() {
  values_.request = {};
  values_.behaviour = {};
  values_.diagnosis.falls = 0;
  values_.diagnosis.risen = 0;
  velocity_ = {};
  low_readings_ = 0;
  calibrating_ = false;
}

// Those of the factory, then what storage has of others.
void Controller::load_parameters() {
  const Calibration before = values_.calibration;
  values_.nmt_startup = kNmtMaster;
  values_.parameters = {};
  values_.feedback = {};
  values_.velocity_limits = {};
  values_.calibration = {};
  values_.walk = {};
  values_.recovery = {};
  parameters_.load();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    change_trim(model_.joints[joint].drive, before.trims[joint], values_.calibration.trims[joint]);
  }
  apply_calibration(values_.calibration);
  velocity_ = walk::clamped(velocity_, values_.velocity_limits);
  values_.velocity = velocity_;
}

void Controller::receive(std::uint64_t now_us) {
  hal::CanFrame frame;
  // Bounded, so that a babbling bus cannot hold the controller in here.
  for (std::size_t i = 0; i < 64 && board_.can.receive(frame); ++i) {
    node_.on_frame(frame, now_us);
    drives_.on_frame(frame);
    sensor_nodes_.on_frame(frame);
  }
}

void Controller::read_inertial_unit(std::uint64_t now_us) {
  for (std::size_t i = 0; i < 16 && board_.imu.read(imu_sample_); ++i) inertial_.add(imu_sample_, now_us);
}

void Controller::read_ankles(std::uint64_t now_us) {
  hal::AnkleSample sample;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    if (!board_.ankles.read(side, sample)) continue;
    const auto foot = static_cast<std::size_t>(side);
    ankle_us_[foot] = now_us;
    std::ranges::copy(sample.force_raw, values_.ankles[foot]);
    std::ranges::copy(sample.torque_raw, values_.ankles[foot] + 3);
  }
}

drive::Starting Controller::starting() const {
  if (!is_operational()) return drive::Starting::kLater;
  if ((values_.nmt_startup & kNoSlaveStart) != 0) return drive::Starting::kByOthers;
  return (values_.nmt_startup & kStartsTogether) != 0 ? drive::Starting::kTogether : drive::Starting::kEach;
}

// Out of operational no target reaches a drive any more. Only a boot may wait in pre-operational, until it
// has to start the drives.
void Controller::watch_network() {
  if (is_operational()) return;
  const bool waits = values_.behaviour.state == State::kBoot && !drives_.configured() &&
                     node_.state() == canopen::NmtState::kPreOperational;
  if (!waits) fail(Reason::kNotOperational);
}

void Controller::watch_bus() {
  hal::CanStatus status = board_.can.status();
  // A lone node becomes error passive and stays so: nobody acknowledges what it says. While the drives boot,
  // that is no error.
  const bool booting = now_us_ - started_us_ < kBusTimeout_us;
  if (booting && status.state == hal::CanErrorState::kErrorPassive) {
    status.state = hal::CanErrorState::kErrorActive;
  }
  node_.on_can_status(status, now_us_);
  values_.diagnosis.receive_overruns = status.receive_overruns;
  values_.diagnosis.imu_overruns = board_.imu.overruns();
  values_.diagnosis.frames_lost = node_.lost_frames();
  if (status.state == hal::CanErrorState::kBusOff) {
    board_.can.recover();
    fail(Reason::kBusOff);
  }
  // With answers it is a bus that is disturbed and works, and the emergency message is enough.
  if (status.state == hal::CanErrorState::kErrorPassive && !drives_.answering()) fail(Reason::kNoAcknowledge);
}

// One frame may be a person's, with cansend.
void Controller::watch_impostors() {
  if (impostor_heard_) {
    impostors_ = fixed::add_saturated(impostors_, std::uint8_t{2});
  } else if (impostors_ > 0) {
    --impostors_;
  }
  impostor_heard_ = false;
  if (impostors_ < kMaxImpostors) return;
  listens_ = true;
  fail(Reason::kSecondMaster);
}

// While it listens, the network belongs to the other one: from then on nothing is said that could disturb it.
void Controller::on_impostor(std::uint16_t) {
  impostor_heard_ = true;
  if (!drives_.resetting()) return;
  listens_ = true;
  drives_.give_up();
  fail(Reason::kSecondMaster);
  node_.mute(true);
}

// What counts is what the drives tell in two seconds: one step under load draws any battery down.
void Controller::watch_battery() {
  const std::optional<std::uint32_t> supply_mV = drives_.take_supply_mV();
  if (!supply_mV) return;
  const bool low = *supply_mV < values_.parameters.supply_low_mV;
  low_readings_ = low ? fixed::add_saturated(low_readings_, std::uint8_t{1}) : std::uint8_t{0};
}

void Controller::watch_sensors(std::uint64_t now_us) {
  const bool starting = !is_operational() || now_us - started_us_ < kSensorStart_us;
  if (values_.behaviour.state == State::kBoot && starting) return;
  const Reason silent = silent_sensor(now_us);
  if (silent != Reason::kNone) fail(silent);
}

Reason Controller::silent_sensor(std::uint64_t now_us) const {
  if (!inertial_.alive(now_us, kSensorTimeout_us)) return Reason::kImuSilent;
  for (const std::optional<std::uint64_t>& last_us : ankle_us_) {
    if (!last_us || now_us - *last_us > kSensorTimeout_us) return Reason::kAnkleSilent;
  }
  return Reason::kNone;
}

// Power-on, once more: no torque, and a boot.
void Controller::on_reset(NmtCommand reset) {
  if (reset == NmtCommand::kResetNode) forget_commands();
  enter(State::kBoot, Reason::kNone);
  if (reset == NmtCommand::kResetNode) {
    load_parameters();
  } else {
    values_.nmt_startup = kNmtMaster;
    parameters_.load(canopen::ParameterGroup::kCommunication);
  }
  connect_drives(node_, model_);
}

// The time-outs of a boot count from here.
void Controller::on_state(canopen::NmtState state) {
  const bool boots = values_.behaviour.state == State::kBoot;
  if (boots && state == canopen::NmtState::kOperational) started_us_ = now_us_;
}

// Until a drive has its configuration it sends a heartbeat each second, as after its reset, which is less
// often than the consumer's time: monitoring begins when all have theirs.
void Controller::on_heartbeat(const canopen::HeartbeatEvent& event) {
  drives_.on_heartbeat(event);
  const bool booted_up = event.kind == canopen::HeartbeatEventKind::kBootedUp;
  if (booted_up || !drives_.configured()) node_.await_heartbeat(event.node_id);
}

}  // namespace koboshi::app
