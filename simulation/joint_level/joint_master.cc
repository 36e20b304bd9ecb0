#include "simulation/joint_level/joint_master.h"

#include <algorithm>

#include "firmware/drive/configuration.h"
#include "firmware/fixed/contract.h"

namespace koboshi::simulation {

JointMaster::JointMaster(const robot::RobotModel& model, hal::StoragePort& storage)
    : model_(model),
      batch_(storage),
      board_(batch_.board()),
      sink_(board_.can),
      node_(app::controller_node(model_),
            {.node_id = drive::kControllerNodeId,
             .serial_number = 1,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), sink_, *this),
      drives_(model_, node_.sink(), values_.drives) {}

void JointMaster::gather(const hal::BatchInput& input) {
  now_us_ = input.now_us;
  ticks_ = input.tick;
  batch_.begin(input);
  board_.watchdog.kick(now_us_);
  if (!started_) {
    started_ = true;
    board_.drive_enable.set(true);
    node_.start(now_us_);
    drives_.boot(now_us_);
  }
  hal::CanFrame frame;
  while (board_.can.receive(frame)) {
    node_.on_frame(frame, now_us_);
    drives_.on_frame(frame);
  }
  node_.process(now_us_);
  drives_.process(now_us_);
  read_sensors();
  if (ticks_) drives_.observe(now_us_);
}

const hal::BatchOutput& JointMaster::respond() {
  if (ticks_) tick();
  return batch_.end();
}

void JointMaster::read_sensors() {
  hal::ImuSample sample;
  while (board_.imu.read(sample)) {
    if (imu_count_ == imu_.size()) {
      ++lost_samples_;
      std::ranges::rotate(imu_, imu_.begin() + 1);
      --imu_count_;
    }
    imu_[imu_count_++] = sample;
  }
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight})
    static_cast<void>(board_.ankles.read(side, ankles_[static_cast<std::size_t>(side)]));
}

void JointMaster::set_targets(std::span<const fixed::Angle> targets) {
  KOBOSHI_ASSERT(targets.size() == model_.joint_count);
  for (std::size_t joint = 0; joint < targets.size(); ++joint)
    targets_[joint] = robot::clamp_to_limits(model_.joints[joint], targets[joint]);
  has_targets_ = true;
}

void JointMaster::hold() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    targets_[joint] = robot::clamp_to_limits(model_.joints[joint], drives_.angle(joint));
}

void JointMaster::tick() {
  node_.on_can_status(board_.can.status(), now_us_);
  const drive::Goal goal =
      drives_.booted() && wants_torque_ ? drive::Goal::kEnabled : drive::Goal::kTorqueOff;
  if (!drives_.enabled() && !has_targets_) hold();
  if (goal != goal_) drives_.set_goal(goal, now_us_);
  goal_ = goal;
  if (drives_.resetting()) return;
  if (drives_.configured()) {
    drives_.command();
    for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
      drives_.set_target(joint, targets_[joint]);
      node_.trigger_tpdo(app::kFirstDriveTpdo + joint, now_us_);
    }
  }
  node_.send_sync(now_us_);
}

// The PDOs of the firmware's commands and telemetry do not exist here.
void JointMaster::on_reset(canopen::NmtCommand /*reset*/) {
  for (std::size_t number = 0; number < app::kFirstDriveRpdo; ++number)
    static_cast<void>(node_.configure_rpdo(number, {}));
  for (std::size_t number = 0; number < app::kTelemetryTpdos; ++number)
    static_cast<void>(node_.configure_tpdo(number, {}));
}

bool JointMaster::on_rpdo(std::size_t number) {
  if (number >= app::kFirstDriveRpdo) drives_.on_answer(number - app::kFirstDriveRpdo);
  return true;
}

// Monitoring begins once all drives are configured, as in the firmware (NodeCallbacks::on_heartbeat).
void JointMaster::on_heartbeat(const canopen::HeartbeatEvent& event) {
  drives_.on_heartbeat(event);
  const bool booted_up = event.kind == canopen::HeartbeatEventKind::kBootedUp;
  if (booted_up || !drives_.configured()) node_.await_heartbeat(event.node_id);
}

}  // namespace koboshi::simulation
