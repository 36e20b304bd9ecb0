#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/node/node.h"
#include "firmware/drive/drive_group.h"
#include "firmware/fixed/units.h"
#include "firmware/robot/model.h"
#include "hal/lockstep/batch_board.h"
#include "hal/port/ankle.h"
#include "hal/port/imu.h"

namespace koboshi::simulation {

// The controller of a robot reduced to its bus: it boots and supervises the drives as the firmware does, with
// the same code, sends their targets in each control cycle, and reads the sensors. What the targets are is
// somebody else's decision; there is no behaviour, no estimation, no feedback and no fall detection.
//
// A call of the firmware has two parts here: gather() takes the input, so that a decision can be made on all
// that the firmware would know, and respond() sends.
class JointMaster final : private canopen::NodeApplication {
 public:
  // Model and storage must outlive the master.
  JointMaster(const robot::RobotModel& model, hal::StoragePort& storage);
  JointMaster(const JointMaster&) = delete;
  JointMaster& operator=(const JointMaster&) = delete;

  void gather(const hal::BatchInput& input);
  // The output is valid until the next gather().
  [[nodiscard]] const hal::BatchOutput& respond();

  // One for each joint; clamped to the joint's limits. Takes effect in the next control cycle.
  void set_targets(std::span<const fixed::Angle> targets);
  // Limits the torque of a joint's drive, 0 to 1,000 per mille of its rated torque. A change travels by SDO
  // and takes some control cycles.
  void set_torque_limit(std::size_t joint, std::uint16_t limit_permille) {
    drives_.set_torque_limit(joint, limit_permille);
  }
  // Enables all drives as soon as they are booted, or switches their torque off. Drives that are enabled hold
  // the present angles until the first targets.
  void enable(bool enabled) { wants_torque_ = enabled; }

  [[nodiscard]] bool booted() const { return drives_.booted(); }
  [[nodiscard]] bool enabled() const { return drives_.enabled(); }
  [[nodiscard]] const drive::JointFault& fault() const { return drives_.fault(); }
  [[nodiscard]] fixed::Angle angle(std::size_t joint) const { return drives_.angle(joint); }
  // As the drive estimates it, in 1/1000 of its rated torque.
  [[nodiscard]] std::int16_t torque_permille(std::size_t joint) const {
    return values_.drives.torque_permille[joint];
  }
  // The lowest of the drives' last readings; 0 before the first.
  [[nodiscard]] std::uint32_t supply_mV() const { return drives_.status().lowest_supply_mV; }
  // The samples of the inertial unit since the last forget_samples(), oldest first.
  [[nodiscard]] std::span<const hal::ImuSample> imu_samples() const {
    return std::span(imu_).first(imu_count_);
  }
  void forget_samples() { imu_count_ = 0; }
  // The latest sample of this side's sensor; zeros before the first.
  [[nodiscard]] const hal::AnkleSample& ankle(hal::Side side) const {
    return ankles_[static_cast<std::size_t>(side)];
  }
  // Samples of the inertial unit that were lost because nobody called forget_samples().
  [[nodiscard]] std::uint32_t lost_samples() const { return lost_samples_; }

 private:
  static constexpr std::size_t kMaxSamples = 1'024;  // of a second at 1 kHz

  void tick();
  void read_sensors();
  void hold();

  canopen::PdoConfiguration default_pdo(canopen::PdoDirection direction, std::size_t number) override {
    return app::drive_pdo(direction, number, model_);
  }
  std::uint32_t default_consumer(std::size_t number) override { return app::drive_consumer(number, model_); }
  void on_reset(canopen::NmtCommand reset) override;
  bool starts_itself() override { return true; }
  bool on_rpdo(std::size_t number) override;
  void on_heartbeat(const canopen::HeartbeatEvent& event) override;
  void on_emergency(const canopen::Emergency& emergency) override { drives_.on_emergency(emergency); }

  const robot::RobotModel& model_;
  hal::BatchBoard batch_;
  hal::Board board_;
  app::ControllerValues values_;
  canopen::CanPortSink sink_;
  canopen::NodeMemory<app::kFirstDriveRpdo + robot::kMaxJoints, app::kTelemetryTpdos + robot::kMaxJoints,
                      robot::kMaxJoints, 32>
      memory_;
  canopen::Node node_;
  drive::DriveGroup drives_;

  std::uint64_t now_us_ = 0;
  bool ticks_ = false;  // this call is one with a tick
  bool started_ = false;
  bool wants_torque_ = true;
  drive::Goal goal_ = drive::Goal::kTorqueOff;
  bool has_targets_ = false;
  std::array<fixed::Angle, robot::kMaxJoints> targets_{};
  std::array<hal::ImuSample, kMaxSamples> imu_{};
  std::size_t imu_count_ = 0;
  std::uint32_t lost_samples_ = 0;
  std::array<hal::AnkleSample, 2> ankles_{};
};

}  // namespace koboshi::simulation
