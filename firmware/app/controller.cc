#include "firmware/app/controller.h"

#include <algorithm>

#include "firmware/app/telemetry.h"
#include "firmware/drive/configuration.h"

namespace koboshi::app {

using behaviour::Reason;
using canopen::NmtCommand;

namespace {

// Emergency error code of the controller itself: device specific (CiA 301, table 26), with state and reason
// beside it.
constexpr std::uint16_t kErrorBehaviour = 0xFF00;

// False, and a robot without joints, when storage holds no valid model.
bool load(const storage::Catalogue& catalogue, robot::RobotModel& model) {
  const auto image = catalogue.find(storage::ItemKind::kRobotModel, 0);
  const bool valid = robot::load_model(image, model) == robot::ModelStatus::kOk;
  if (!valid) model.joint_count = 0;
  return valid;
}

}  // namespace

Controller::Controller(const hal::Board& board)
    : board_(board),
      catalogue_(board.storage.contents()),
      items_(board.storage, storage::kRobotLayout),
      model_valid_(load(catalogue_, model_)),
      sink_(board.can),
      node_(kControllerNode,
            {.node_id = drive::kControllerNodeId,
             .serial_number = 1,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), sink_, *this),
      parameters_(items_, node_),
      motions_(catalogue_, items_, model_),
      motion_transfer_(items_, model_, motions_),
      drives_(model_, node_.sink(), values_.drives),
      sensor_nodes_(board.sensor_nodes, node_.sink()),
      network_(board.can, node_, drives_),
      estimator_(model_),
      behaviour_(model_, model_valid_, motions_,
                 {.power = values_.parameters,
                  .velocity_limits = values_.velocity_limits,
                  .walk = values_.walk,
                  .recovery = values_.recovery}),
      feedback_(model_),
      requests_(values_, model_, behaviour_, estimator_, drives_) {}

void Controller::service(std::uint64_t now_us) {
  now_us_ = now_us;
  board_.watchdog.kick(now_us);
  if (!started_) start(now_us);
  receive(now_us);
  node_.process(now_us);
  drives_.process(now_us, starting());
  if (!drives_.resetting())
    sensor_nodes_.process(network_.operational() && (values_.nmt_startup & kNoSlaveStart) == 0);
  items_.process();
  parameters_.process();
  values_.diagnosis.motions = motions_.valid();
  read_inertial_unit(now_us);
}

void Controller::tick(std::uint64_t now_us) {
  drives_.observe(now_us);
  read_ankles(now_us);
  const drive::DriveStatus drives = drives_.status();
  const bool rests = behaviour::kResting.contains(behaviour_.state());
  const behaviour::NetworkStatus network =
      network_.update(behaviour_.state() == behaviour::State::kBoot, now_us);

  const estimation::RobotState& robot = estimator_.update(drives.angles, rests, now_us);
  const behaviour::Decision& decision = behaviour_.step(robot, drives, network, now_us);
  requests_.end_calibration();

  carry_out(decision, now_us);
  publish();
  if (!network_.operational() || drives_.resetting()) return;
  if (drives_.configured()) command_drives(decision, robot, now_us);
  node_.send_sync(now_us);
}

void Controller::start(std::uint64_t now_us) {
  started_ = true;
  values_.diagnosis.model_id = model_.id;
  motions_.load();
  node_.start(now_us);
}

// --- What comes in

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
  for (std::size_t i = 0; i < 16 && board_.imu.read(imu_sample_); ++i) estimator_.add(imu_sample_, now_us);
}

void Controller::read_ankles(std::uint64_t now_us) {
  hal::AnkleSample sample;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    if (!board_.ankles.read(side, sample)) continue;
    estimator_.add(side, sample, now_us);
    auto& shown = values_.ankles[static_cast<std::size_t>(side)];
    std::ranges::copy(sample.force_raw, shown);
    std::ranges::copy(sample.torque_raw, shown + 3);
  }
}

drive::Starting Controller::starting() const {
  if (!network_.operational()) return drive::Starting::kLater;
  if ((values_.nmt_startup & kNoSlaveStart) != 0) return drive::Starting::kByOthers;
  return (values_.nmt_startup & kStartsTogether) != 0 ? drive::Starting::kTogether : drive::Starting::kEach;
}

canopen::AbortCode Controller::on_write(canopen::ObjectAddress address, std::uint32_t value) {
  const canopen::AbortCode answer = requests_.write(address, value, now_us_);
  carry_out(behaviour_.decision(), now_us_);
  return answer;
}

void Controller::on_rpdo(std::size_t number) {
  if (number >= kFirstDriveRpdo) return drives_.on_answer(number - kFirstDriveRpdo);
  if (number == kVelocityRpdo) requests_.take_velocity();
  if (number == kCommandRpdo) requests_.take_command(now_us_);
  carry_out(behaviour_.decision(), now_us_);
}

canopen::Domain* Controller::domain(canopen::ObjectAddress address) {
  const auto number = static_cast<std::uint16_t>(address.subindex - 1);
  motion_transfer_.select(number, may_store());
  return &motion_transfer_;
}

canopen::AbortCode Controller::on_store(canopen::ParameterGroup) {
  return parameters_.store(canopen::ParameterGroup::kAll, may_store());
}

canopen::AbortCode Controller::on_restore(canopen::ParameterGroup) {
  return parameters_.restore(canopen::ParameterGroup::kAll, may_store());
}

// Power-on, once more: no torque, and a boot.
void Controller::on_reset(NmtCommand reset) {
  const bool node = reset == NmtCommand::kResetNode;
  if (node) values_.request = {};
  behaviour_.restart(node, now_us_);
  carry_out(behaviour_.decision(), now_us_);
  if (node) {
    requests_.reset_parameters();
    values_.diagnosis.factory_parameters = load_factory_parameters();
    parameters_.load();
    requests_.apply_parameters();
  } else {
    values_.nmt_startup = kNmtMaster;
    parameters_.load(canopen::ParameterGroup::kCommunication);
  }
  connect_drives(node_, model_);
}

FactoryStatus Controller::load_factory_parameters() {
  return app::load_factory_parameters(
      catalogue_.find(storage::ItemKind::kFactoryParameters, 0), model_.id,
      canopen::Dictionary(kControllerNode.rows, std::as_writable_bytes(std::span(&values_, 1))));
}

// Reports parameters of the factory that are there and cannot be used: before a node is pre-operational it
// sends no emergency messages.
void Controller::report_factory_parameters() {
  const FactoryStatus status = values_.diagnosis.factory_parameters;
  if (status == FactoryStatus::kLoaded || status == FactoryStatus::kNone) return;
  node_.raise_error(canopen::error_code::kDataSet, canopen::error_register::kManufacturer,
                    {static_cast<std::uint8_t>(status)});
}

void Controller::on_state(canopen::NmtState state) {
  if (state == canopen::NmtState::kPreOperational) report_factory_parameters();
  const bool boots = behaviour_.state() == behaviour::State::kBoot;
  if (boots && state == canopen::NmtState::kOperational) network_.on_operational(now_us_);
}

// Until a drive has its configuration it sends a heartbeat each second, as after its reset, which is less
// often than the consumer's time: monitoring begins when all have theirs.
void Controller::on_heartbeat(const canopen::HeartbeatEvent& event) {
  drives_.on_heartbeat(event);
  const bool booted_up = event.kind == canopen::HeartbeatEventKind::kBootedUp;
  if (booted_up || !drives_.configured()) node_.await_heartbeat(event.node_id);
}

// While it listens, the network belongs to the other one: from then on nothing is said that could disturb it.
void Controller::on_impostor(std::uint16_t) {
  if (!network_.on_impostor()) return;
  drives_.give_up();
  behaviour_.fail(Reason::kSecondMaster, drives_.trouble(), now_us_);
  carry_out(behaviour_.decision(), now_us_);
  node_.mute(true);
}

// --- What goes out

// Torque first: an emergency stop waits for nothing.
void Controller::carry_out(const behaviour::Decision& decision, std::uint64_t now_us) {
  board_.drive_enable.set(decision.drive_enable);
  if (decision.boots != done_.boots) boot(now_us);
  if (decision.fault && !done_.fault) report(*decision.fault);
  if (decision.low_battery && !done_.low_battery)
    node_.raise_error(canopen::cia402::kErrorUnderVoltage, canopen::error_register::kVoltage, {});
  if (!decision.low_battery && done_.low_battery) node_.clear_error(canopen::cia402::kErrorUnderVoltage);
  if (decision.goals != done_.goals) drives_.set_goal(decision.goal, now_us);
  done_ = {decision.boots, decision.goals, decision.fault.has_value(), decision.low_battery};
  show(behaviour_, values_);
}

void Controller::report(const behaviour::FaultReport& fault) {
  node_.raise_error(kErrorBehaviour, canopen::error_register::kManufacturer,
                    {static_cast<std::uint8_t>(fault.state), static_cast<std::uint8_t>(fault.reason),
                     static_cast<std::uint8_t>(fault.trouble.kind), fault.trouble.joint, 0});
}

void Controller::boot(std::uint64_t now_us) {
  node_.mute(false);
  node_.clear_error(kErrorBehaviour);
  const std::uint64_t reset_us = network_.begin_boot(now_us);
  if (model_valid_) drives_.boot(reset_us);
  sensor_nodes_.reset();
}

void Controller::command_drives(const behaviour::Decision& decision, const estimation::RobotState& robot,
                                std::uint64_t now_us) {
  drives_.command();
  auto targets = decision.targets;
  feedback_.correct(decision.feedback, values_.feedback,
                    estimation::trunk_motion(robot, decision.planned_pitch), targets);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    drives_.set_target(joint, robot::clamp_to_limits(model_.joints[joint], targets[joint]));
    node_.trigger_tpdo(kFirstDriveTpdo + joint, now_us);
  }
}

void Controller::publish() {
  show(estimator_.state(), values_);
  show(estimator_, values_);
  values_.diagnosis.receive_overruns = network_.can_status().receive_overruns;
  values_.diagnosis.imu_overruns = board_.imu.overruns();
  values_.diagnosis.frames_lost = node_.lost_frames();
}

}  // namespace koboshi::app
