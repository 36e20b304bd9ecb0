#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/app/decision_executor.h"
#include "firmware/app/dictionary.h"
#include "firmware/app/network_watch.h"
#include "firmware/app/node_callbacks.h"
#include "firmware/app/policy_control.h"
#include "firmware/app/requests.h"
#include "firmware/app/sensor_nodes.h"
#include "firmware/balance/feedback.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node/node.h"
#include "firmware/drive/drive_group.h"
#include "firmware/estimation/estimator.h"
#include "firmware/motion/motion_library.h"
#include "firmware/policy/policy_slot.h"
#include "firmware/robot/model.h"
#include "firmware/storage/catalogue.h"
#include "firmware/storage/item_store.h"
#include "hal/port/board.h"
#include "hal/port/period.h"

namespace koboshi::app {

// The firmware as a whole: wires the stages of a control cycle to the board and the bus. A board constructs
// one Controller, calls `service` each millisecond and `tick` after each tenth of them, and does nothing
// else. The robot model and the motions come from storage (storage/catalogue.h).
//
// The path from a gyro sample to a joint target is a pipeline: the first row runs in `service`, the others in
// `tick`. Each stage takes and returns values, and is tested without bus and board:
//
//   samples      read_inertial_unit -> Estimator::add(ImuSample)              1 kHz, filters at 500 Hz
//   estimation   Estimator::update(joint angles) -> RobotState                100 Hz
//   behaviour    Behaviour::step(RobotState, DriveStatus, ...) -> Decision    100 Hz
//   policy       PolicyControl::step: offsets on the walk's targets, if it is on      100 Hz
//   balance      joint_targets(Decision, RobotState) -> JointAngles           100 Hz
//   drives       command_drives(JointAngles)                                  100 Hz
class Controller final {
 public:
  static constexpr std::uint32_t kTick_us = hal::kControlPeriod_us;

  // The board must outlive the controller.
  explicit Controller(const hal::Board& board);

  // Both are never inlined, so that they can be found in an image and measured. `now_us`: since power-on.
  //
  // Receives and answers CAN frames, reads the sensors, boots drives and sensor nodes, continues storage
  // operations, and kicks the watchdog. At 1 kHz.
  [[gnu::noinline]] void service(std::uint64_t now_us);
  // One control cycle: samples to joint targets, RPDOs, SYNC, telemetry. At 100 Hz.
  [[gnu::noinline]] void tick(std::uint64_t now_us);

  // Returns the values behind the object dictionary, for tests and for the record of a run.
  const ControllerValues& values() const { return values_; }
  const robot::RobotModel& model() const { return model_; }
  // Returns the offsets of the policy and the signals that it saw, for training, which may deviate from them.
  const policy::Residual& residual() const { return policy_control_.residual(); }
  policy::Residual& residual() { return policy_control_.residual(); }

 private:
  using JointAngles = std::array<fixed::Angle, robot::kMaxJoints>;

  void start(std::uint64_t now_us);
  void receive(std::uint64_t now_us);
  void read_inertial_unit(std::uint64_t now_us);
  void read_ankles(std::uint64_t now_us);
  JointAngles joint_targets(const behaviour::Decision& decision, const estimation::RobotState& robot) const;
  void command_drives(const JointAngles& targets, std::uint64_t now_us);
  void set_up_drives(const behaviour::Decision& decision);
  void report_refusals();
  void report_refusal(std::uint32_t joints, std::uint16_t error, std::uint32_t& shown);
  void publish();

  hal::Board board_;
  storage::Catalogue catalogue_;
  storage::ItemStore items_;
  robot::RobotModel model_;
  const bool model_valid_;
  ControllerValues values_;
  motion::MotionLibrary motions_;
  policy::PolicySlot policy_;

  NodeCallbacks callbacks_;
  canopen::CanPortSink sink_;
  canopen::NodeMemory<kRpdos, kTelemetryTpdos + robot::kMaxJoints, robot::kMaxJoints, 32> memory_;
  canopen::Node node_;
  drive::DriveGroup drives_;
  SensorNodes sensor_nodes_;
  NetworkWatch network_;

  estimation::Estimator estimator_;
  behaviour::Behaviour behaviour_;
  balance::Feedback feedback_;
  Requests requests_;
  DecisionExecutor executor_;
  PolicyControl policy_control_;

  hal::ImuSample imu_sample_;   // a member, so that it need not be cleared each millisecond
  std::uint32_t softened_ = 0;  // joints whose torque the last decision limited; bit i: joint i
  std::uint32_t regained_ = 0;  // joints to whose position loops it gave another gain than their own
  bool started_ = false;
};

}  // namespace koboshi::app
