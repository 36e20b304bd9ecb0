#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/app/behaviour.h"
#include "firmware/app/catalogue.h"
#include "firmware/app/dictionary.h"
#include "firmware/app/item_store.h"
#include "firmware/app/motion_index.h"
#include "firmware/app/motion_transfer.h"
#include "firmware/app/sensor_nodes.h"
#include "firmware/balance/attitude.h"
#include "firmware/balance/feedback.h"
#include "firmware/balance/gyro_bias.h"
#include "firmware/balance/inertial.h"
#include "firmware/balance/posture.h"
#include "firmware/balance/zmp.h"
#include "firmware/canopen/node.h"
#include "firmware/canopen/parameter_store.h"
#include "firmware/drive/drive_group.h"
#include "firmware/motion/interpreter.h"
#include "firmware/recovery/fall_watch.h"
#include "firmware/recovery/lying.h"
#include "firmware/recovery/motions.h"
#include "firmware/recovery/stillness.h"
#include "firmware/robot/model.h"
#include "firmware/walk/walker.h"
#include "hal/port/board.h"

namespace koboshi::app {

// The firmware as a whole. A board constructs one, calls `service` each millisecond and `tick` after each
// tenth of them, and does nothing else. Which robot it is on and what motions it knows comes from storage
// (catalogue.h).
class Controller final : private canopen::NodeApplication {
 public:
  static constexpr std::uint32_t kTick_us = 10'000;
  static constexpr std::uint32_t kSensorTimeout_us = 50'000;
  // Of the supply in a row: two seconds.
  static constexpr std::uint8_t kLowReadings = 2'000'000 / drive::DriveGroup::kSupplyPeriod_us;
  static constexpr std::uint32_t kSensorStart_us = 500'000;  // how long sensors may take to speak first
  // How long it listens for another master before it resets the network: three cycles of one.
  static constexpr std::uint64_t kListen_us = 30'000;
  // Cycles in which a second master was heard count two, the others take one off: so many are no accident.
  static constexpr std::uint8_t kMaxImpostors = 10;

  explicit Controller(const hal::Board& board);

  // Both are never inlined, so that they can be found in an image and measured.
  //
  // Receives, answers, watches: CAN, the drives' boot, sensors, watchdog. At 1 kHz.
  [[gnu::noinline]] void service(std::uint64_t now_us);
  // One control cycle: behaviour, targets, RPDOs, SYNC, telemetry. At 100 Hz.
  [[gnu::noinline]] void tick(std::uint64_t now_us);

  // What the object dictionary shows; for tests and for the record of a run.
  const ControllerValues& values() const { return values_; }
  const robot::RobotModel& model() const { return model_; }

 private:
  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  // canopen::NodeApplication
  canopen::AbortCode on_write(canopen::ObjectAddress address, std::uint32_t value) override;
  canopen::Domain* domain(canopen::ObjectAddress address) override;
  canopen::AbortCode on_store(canopen::ParameterGroup group) override;
  canopen::AbortCode on_restore(canopen::ParameterGroup group) override;
  void on_reset(canopen::NmtCommand reset) override;
  bool starts_itself() override { return (values_.nmt_startup & kNoSelfStart) == 0; }
  void on_state(canopen::NmtState state) override;
  void on_rpdo(std::size_t number) override;
  void on_heartbeat(const canopen::HeartbeatEvent& event) override;
  void on_emergency(const canopen::Emergency& emergency) override { drives_.on_emergency(emergency); }
  void on_impostor(std::uint16_t identifier) override;

  void start(std::uint64_t now_us);
  void load_motions();
  void forget_commands();
  void load_parameters();
  std::span<const std::byte> motion_image(std::uint16_t number) const;
  bool open_motion(std::uint16_t number, motion::Motion& motion) const;
  void receive(std::uint64_t now_us);
  void read_inertial_unit(std::uint64_t now_us);
  void read_ankles(std::uint64_t now_us);
  bool is_operational() const { return node_.state() == canopen::NmtState::kOperational; }
  drive::Starting starting() const;
  void watch_network();
  void watch_bus();
  void watch_impostors();
  void watch_sensors(std::uint64_t now_us);
  void watch_battery();
  bool battery_low() const { return low_readings_ >= kLowReadings; }
  Reason silent_sensor(std::uint64_t now_us) const;

  // What the sensors tell of the robot (estimation.cc).
  void estimate();
  void estimate_attitude();
  void calibrate_gyro(const balance::InertialSensor::Rates& raw);
  void give_up_calibration();
  void estimate_balance();

  // Commands, as they arrive (commands.cc): why one is refused, kNone when it was obeyed.
  Reason obey(Command command, std::int16_t argument);
  Reason try_to_obey(Command command, std::int16_t argument);
  Reason enable();
  Reason play(std::int16_t number);
  Reason stop();
  Reason walk();
  Reason get_up();
  Reason obey_event(Event event);
  Reason refusal_to_enable() const;
  // An SDO client's velocity, or a limit of it, in one of its parts (a sub-index).
  canopen::AbortCode set_velocity(std::uint8_t subindex, std::int16_t value);
  void set_velocity_limit(std::uint8_t subindex, std::int16_t value);
  void take_velocity();
  // A part of the calibration, at a sub-index; kDeviceState when it may not change now.
  canopen::AbortCode set_calibration(canopen::ObjectAddress address, std::int32_t value);
  void set_trim(std::size_t joint, std::int16_t trim);
  void apply_calibration(const Calibration& calibration);
  Reason calibrate();

  // The state machine (states.cc): one function a state, called each tick while the state lasts.
  void handle(Event event, Reason reason);
  void enter(State state, Reason reason);
  void fail(Reason reason);
  void run_state(std::uint64_t now_us);
  void run_boot(std::uint64_t now_us);
  void run_enabling();
  void run_soft_start();
  void run_standing();
  void run_motion();
  void run_walking();
  void run_fault(std::uint64_t now_us);
  // Of a fall and what comes after it (recovery.cc).
  void watch_for_falls();
  void begin_falling(recovery::FallDirection direction);
  bool begin_recovery_motion(recovery::Role role);
  void run_falling(std::uint64_t now_us);
  void stand_up_straight(Reason reason);
  void run_fallen(std::uint64_t now_us);
  void run_righting();
  void right_lying();
  void turn_from_side(recovery::Role roll, Reason side);
  void rise(recovery::Role role, Reason lying);
  void rise_from_seat();
  fixed::Angle thigh_pitch() const;
  void run_getting_up();
  void run_steadying(std::uint64_t now_us);
  std::uint32_t pace_percent() const;

  void stop_moving();
  void begin_soft_start();
  void follow_actual();

  // What goes onto the bus (output.cc).
  void publish(std::uint64_t now_us);
  void command_drives(std::uint64_t now_us);
  balance::TrunkMotion trunk_motion() const;
  void balance(Angles& targets) const;
  void publish_telemetry();

  hal::Board board_;
  Catalogue catalogue_;
  ItemStore items_;
  robot::RobotModel model_;
  bool model_valid_;
  robot::Rotation R_BI_;  // the model's, without the mounting
  ControllerValues values_;
  canopen::CanPortSink sink_;
  canopen::NodeMemory<kFirstDriveRpdo + robot::kMaxJoints, kTelemetryTpdos + robot::kMaxJoints,
                      robot::kMaxJoints, 32>
      memory_;
  canopen::Node node_;
  canopen::ParameterStore parameters_;
  MotionIndex motion_index_;
  MotionTransfer motion_transfer_;
  drive::DriveGroup drives_;
  SensorNodes sensor_nodes_;
  hal::ImuSample imu_sample_;  // here, so that it need not be cleared each millisecond
  balance::InertialSensor inertial_;
  balance::GyroBias gyro_bias_;
  bool calibrating_ = false;  // the next second of rest is for the parameters too
  balance::AttitudeEstimator attitude_;
  balance::Feedback feedback_;
  std::array<balance::FootSensor, 2> foot_sensors_;  // by Side
  motion::Interpreter interpreter_;
  walk::Walker walker_;
  std::array<fixed::Force, 2> foot_loads_{};              // by Side
  std::array<std::optional<std::uint64_t>, 2> ankle_us_;  // when each ankle spoke last
  recovery::FallWatch fall_watch_;
  recovery::Stillness stillness_;
  bool has_rolled_ = false;        // in this attempt to get up
  std::uint64_t entered_us_ = 0;   // when the present state began
  std::uint8_t low_readings_ = 0;  // of the supply, in a row
  bool impostor_heard_ = false;    // a second master, in this cycle
  std::uint8_t impostors_ = 0;
  bool listens_ = true;  // at the next boot: there may be another master
  std::uint64_t now_us_ = 0;
  std::uint64_t started_us_ = 0;  // of the boot, or when the controller became operational in it
  bool started_ = false;
  balance::InertialSensor::Rates rates_{};  // of the trunk, in its axes, free of the gyro's bias
  balance::InertialSensor::Accelerations accelerations_{};
  walk::Velocity velocity_;  // the last that was obeyed
  Angles targets_{};
  Angles ramp_from_{};
  Angles ramp_to_{};
  std::int32_t ramp_elapsed_us_ = 0;
  std::int32_t ramp_time_us_ = 0;
};

}  // namespace koboshi::app
