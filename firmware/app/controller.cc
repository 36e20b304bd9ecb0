#include "firmware/app/controller.h"

#include <algorithm>

#include "firmware/app/telemetry.h"
#include "firmware/robot/abilities.h"

namespace koboshi::app {
namespace {

// A babbling bus or sensor cannot hold the controller for longer than this.
constexpr std::size_t kMaxFramesPerService = 64;
constexpr std::size_t kMaxSamplesPerService = 16;

// Emergency error codes of the controller: device specific (CiA 301, table 26). A mask of the joints follows
// in the manufacturer's field.
constexpr std::uint16_t kErrorNoTorqueLimit = 0xFF01;
constexpr std::uint16_t kErrorNoPositionGain = 0xFF03;
constexpr unsigned kPermillePerPercent = drive::Setting::kOwn_permille / motion::Stiffness::kFull;
static_assert(motion::Gain::kMax * kPermillePerPercent <= drive::kMaxPositionGain_permille);

// False, and a robot without joints, when storage holds no valid model.
bool load(const storage::Catalogue& catalogue, robot::RobotModel& model) {
  const auto image = catalogue.find(storage::ItemKind::kRobotModel, 0);
  const bool valid = robot::load_model(image, model) == robot::ModelStatus::kOk;
  if (!valid) model.joint_count = model.follower_count = 0;
  return valid;
}

}  // namespace

Controller::Controller(const hal::Board& board)
    : board_(board),
      catalogue_(board.storage.contents()),
      items_(board.storage, storage::kRobotLogSize_bytes),
      model_valid_(load(catalogue_, model_)),
      motions_(catalogue_, items_, model_),
      policy_(catalogue_, items_, model_),
      callbacks_({.values = values_,
                  .catalogue = catalogue_,
                  .model = model_,
                  .node = node_,
                  .items = items_,
                  .motions = motions_,
                  .policy = policy_,
                  .drives = drives_,
                  .network = network_,
                  .behaviour = behaviour_,
                  .requests = requests_,
                  .executor = executor_}),
      sink_(board.can),
      node_(controller_node(model_),
            {.node_id = drive::kControllerNodeId,
             .serial_number = 1,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), sink_, callbacks_),
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
      requests_(values_, model_, behaviour_, estimator_, drives_),
      executor_(board_.drive_enable, node_, network_, drives_, sensor_nodes_, model_valid_),
      policy_control_(policy_, model_, values_, node_) {}

void Controller::service(std::uint64_t now_us) {
  board_.watchdog.kick(now_us);
  callbacks_.set_time(now_us);
  if (!started_) start(now_us);
  receive(now_us);
  node_.process(now_us);
  const drive::Starting starting = network_.starting(values_.nmt_startup);
  drives_.process(now_us, starting);
  if (!drives_.resetting()) sensor_nodes_.process(NetworkWatch::starts_nodes(starting));
  items_.process();
  callbacks_.process();
  std::ranges::copy(motions_.valid(), values_.diagnosis.motions);
  read_inertial_unit(now_us);
}

void Controller::tick(std::uint64_t now_us) {
  drives_.observe(now_us);
  read_ankles(now_us);
  const drive::DriveStatus drives = drives_.status();
  const behaviour::NetworkStatus network =
      network_.update(behaviour_.state() == behaviour::State::kBoot, now_us);
  const bool rests = behaviour::kResting.contains(behaviour_.state());

  const behaviour::Decision& last = behaviour_.decision();
  const estimation::RobotState& robot =
      estimator_.update(drives.angles, rests, now_us,
                        {.torques_permille = bus_values(values_).torques_permille,
                         .walks = last.feedback == balance::FeedbackMode::kWalking,
                         .swing = last.swing,
                         .reference = last.reference,
                         .stands_still = behaviour_.state() == behaviour::State::kStanding});
  const behaviour::Decision& decision = behaviour_.step({.robot = robot,
                                                         .drives = drives,
                                                         .network = network,
                                                         .values = bus_values(values_),
                                                         .now_us = now_us});
  policy_control_.step(behaviour_, robot, {drives.angles.data(), model_.joint_count});
  requests_.end_calibration();
  executor_.execute(decision, now_us);
  set_up_drives(decision);
  publish();
  if (!network_.operational() || drives_.resetting()) return;
  if (drives_.configured()) command_drives(joint_targets(decision, robot), now_us);
  node_.send_sync(now_us);
}

void Controller::start(std::uint64_t now_us) {
  started_ = true;
  values_.diagnosis.model_id = model_.id;
  values_.lost_abilities = robot::lost_abilities(model_);
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight})
    std::ranges::copy(estimator_.wrench(side), values_.ankles[static_cast<std::size_t>(side)]);
  motions_.load();
  policy_.load();
  node_.start(now_us);
}

// --- Input

void Controller::receive(std::uint64_t now_us) {
  hal::CanFrame frame;
  for (std::size_t i = 0; i < kMaxFramesPerService && board_.can.receive(frame); ++i) {
    node_.on_frame(frame, now_us);
    drives_.on_frame(frame);
    sensor_nodes_.on_frame(frame);
  }
}

void Controller::read_inertial_unit(std::uint64_t now_us) {
  for (std::size_t i = 0; i < kMaxSamplesPerService && board_.imu.read(imu_sample_); ++i)
    estimator_.add(imu_sample_, now_us);
}

void Controller::read_ankles(std::uint64_t now_us) {
  hal::AnkleSample sample;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    if (!board_.ankles.read(side, sample)) continue;
    estimator_.add(side, sample, now_us);
    std::ranges::copy(estimator_.wrench(side), values_.ankles[static_cast<std::size_t>(side)]);
  }
}

// --- Output

// Adds the offsets of the policy and the feedback to the targets of the decision, and clamps them to the
// joints' limits.
Controller::JointAngles Controller::joint_targets(const behaviour::Decision& decision,
                                                  const estimation::RobotState& robot) const {
  JointAngles targets = decision.targets;
  policy_control_.add_to(targets);
  feedback_.correct(decision.feedback, values_.feedback,
                    estimation::trunk_motion(robot, decision.planned_pitch), decision.support, targets);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    targets[joint] = robot::clamp_to_limits(model_.joints[joint], targets[joint]);
  return targets;
}

// Controlwords and targets go into the object dictionary, and from there in one PDO to each drive.
void Controller::command_drives(const JointAngles& targets, std::uint64_t now_us) {
  drives_.command();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    drives_.set_target(joint, targets[joint]);
    node_.trigger_tpdo(kFirstDriveTpdo + joint, now_us);
  }
}

// Torque limits and gains of the drives. Joints outside of a mask have what their drives have by themselves.
void Controller::set_up_drives(const behaviour::Decision& decision) {
  const auto share_permille = [](std::uint32_t joints, std::size_t joint, std::uint8_t percent) {
    const bool is_changed = (joints >> joint & 1u) != 0;
    return is_changed ? static_cast<std::uint16_t>(percent * kPermillePerPercent)
                      : drive::Setting::kOwn_permille;
  };
  if ((decision.softened | decision.regained | softened_ | regained_) == 0) return;
  softened_ = decision.softened;
  regained_ = decision.regained;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    drives_.set_torque_limit(joint, share_permille(softened_, joint, decision.stiffness_percent[joint]));
    drives_.set_position_gain(joint, share_permille(regained_, joint, decision.gain_percent[joint]));
  }
}

void Controller::report_refusals() {
  auto& diagnosis = values_.diagnosis;
  report_refusal(drives_.without_torque_limit(), kErrorNoTorqueLimit, diagnosis.without_torque_limit);
  report_refusal(drives_.without_position_gain(), kErrorNoPositionGain, diagnosis.without_position_gain);
}

// Reports once that drives refuse a setting; `shown`, a value of 0x2200, is which. The next boot clears it.
void Controller::report_refusal(std::uint32_t joints, std::uint16_t error, std::uint32_t& shown) {
  if (joints != 0) {
    std::array<std::uint8_t, 5> field{};
    canopen::store_u32(field.data(), joints);
    node_.raise_error(error, canopen::error_register::kManufacturer, field);
  } else if (shown != 0) {
    node_.clear_error(error);
  }
  shown = joints;
}

void Controller::publish() {
  show(behaviour_, values_);
  show(estimator_.state(), values_);
  show(estimator_, values_);
  values_.diagnosis.receive_overruns = network_.can_status().receive_overruns;
  values_.diagnosis.imu_overruns = board_.imu.overruns();
  values_.diagnosis.frames_lost = node_.lost_frames();
  report_refusals();
}

}  // namespace koboshi::app
