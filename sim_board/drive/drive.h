#pragma once

#include <cstdint>
#include <optional>

#include "firmware/canopen/node/device_services.h"
#include "firmware/canopen/node/node.h"
#include "sim_board/can/bus.h"
#include "sim_board/can/bus_off_pause.h"
#include "sim_board/can/canopen_filter.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/drive/drive_state.h"
#include "sim_board/drive/homing.h"
#include "sim_board/drive/position_demand.h"
#include "sim_board/drive/position_watch.h"
#include "sim_board/drive/profile_position.h"
#include "sim_board/drive/servo_monitor.h"
#include "sim_board/drive/velocity_estimate.h"
#include "sim_board/sensor/scalar_sensor.h"
#include "sim_board/servo/servo.h"
#include "sim_board/storage/node_storage.h"

namespace koboshi::sim_board {

// A servo drive: a CANopen node after CiA 402, in cyclic synchronous position mode, profile position mode or
// homing mode, around the hardware of one servo. It answers frames at the microsecond at which they reach it,
// and obeys a controlword then; its own loop, with which the values that it shows are renewed, runs at 1 kHz.
// SYNC samples them, and is the beat of the cyclic targets.
class Drive final : private BusNode,
                    private canopen::FrameSink,
                    private canopen::NodeApplication,
                    private canopen::DeviceOwner {  // Large: one short function per object and mode
 public:
  static constexpr std::uint64_t kBootTime_us = 50'000;  // from power to the boot-up message
  static constexpr std::uint64_t kSyncTolerance = 5;     // cycles without SYNC that a moving drive bears
  static constexpr std::uint64_t kStandTime_us =
      100'000;                                      // how long it holds after a stop before the torque goes
  static constexpr std::size_t kTransmitFifo = 16;  // each

  // Stands on the bus from now on, without power until power_on(). The bus must outlive it.
  Drive(const JointDescription& joint, Bus& bus, const ServoOptions& options = {});
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  // The drive-enable line: while it is low the drive makes no torque, whatever its state.
  void set_enable_line(bool high) {
    enable_line_ = high;
    if (!high && powered_ && !hanging_) state_.torque_off();
  }
  // Samples the servo and runs the loop once, every PositionController::kPeriod_s.
  void update(const JointState& joint, std::uint64_t now_us);
  // Motor and gears in the next physics step: what they draw of the supply, and what the joint feels.
  SupplyLoad draw(const JointState& joint) { return servo_.draw(joint); }
  ServoTorque torque(double supply_V) { return servo_.torque(supply_V); }

  void power_on(std::uint64_t now_us);
  void power_off();
  // A processor that hangs: neither hears nor speaks nor computes; the motor stays as it was driven last.
  void hang();
  // A cable that tears: the position is no longer read, and without it the drive cannot stop on a ramp.
  void break_encoder() { servo_.break_encoder(); }
  // A winding that is too hot, from whatever cause.
  void overheat() { servo_.overheat(); }

  // Has power and does not hang.
  bool listens() const { return powered_ && !hanging_; }
  canopen::cia402::State state() const { return state_.state(); }
  bool makes_torque() const { return powered_ && enable_line_ && state_.makes_torque(); }
  const DriveValues& values() const { return values_; }
  double current_A() const { return servo_.current_A(); }
  double torque_Nm() const { return servo_.torque_Nm(); }
  double winding_C() const { return servo_.winding().temperature_C(); }
  NodeHandle bus_handle() const { return handle_; }

  void archive(StateArchive& archive);

 private:
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;
  bool send(const hal::CanFrame& frame) override;
  bool pending(hal::TransmitFifo fifo) const override { return bus_.transmit_pending(handle_, fifo); }
  canopen::AbortCode on_write(canopen::ObjectAddress address, std::uint32_t value) override;
  canopen::AbortCode on_store(canopen::ParameterGroup group) override { return storage_.store(group); }
  canopen::AbortCode on_restore(canopen::ParameterGroup group) override { return storage_.restore(group); }
  canopen::AbortCode on_store_node_id(std::uint8_t node_id) override {
    return storage_.store_node_id(node_id);
  }
  void on_node_id(std::uint8_t node_id) override { description_.second_sdo = pc_channel(node_id); }
  void on_reset(canopen::NmtCommand reset) override;
  bool on_rpdo(std::size_t number) override;
  void on_sync(std::uint64_t now_us) override;
  void on_state(canopen::NmtState state) override;
  void on_heartbeat(const canopen::HeartbeatEvent& event) override;

  void forget_motion();
  void obey(std::uint16_t controlword);
  void check_parameters(canopen::cia402::State before);
  void report_parameters(bool contradict);
  void restart_motion(std::uint16_t controlword);
  void forget_target();
  void give_target(std::int32_t target) {
    values_.target_position = target;
    target_given_ = true;
  }
  void fault(std::uint16_t error_code, std::uint8_t register_bits);
  // Obeys 0x6007 when the controller is lost, or takes the node out of operational.
  void abort_connection(std::uint16_t error_code);
  bool slows_down_before(std::uint16_t controlword);
  bool follows_targets() const {
    return state_.state() == canopen::cia402::State::kOperationEnabled && !leaving_by_;
  }
  void begin_stop(std::int16_t option);
  void brake(double deceleration_units_per_s2);
  double deceleration(std::int16_t option) const;  // units/s^2
  void finish_stop();
  void run_loop();
  void change_mode();
  void make_home();
  // The shaft's position as the bus counts it: from home, or from the encoder's own zero.
  std::int32_t position_units() const { return servo_.position_units() + home_units_; }
  void watch_bus();
  void watch_sync();
  void watch_servo();
  void watch_position();
  void measure();
  void follow_target();
  void step_profile();
  bool limited() const;
  std::uint16_t mode_bits() const;  // of the statusword
  void show();
  // Updates the torque in the object dictionary. In a limp servo, which carries no current, it is unchanged.
  void show_torque() {
    if (servo_.current_A() != shown_current_A_) compute_torque();
  }
  void compute_torque();

  const JointDescription& joint_;
  Bus& bus_;
  NodeHandle handle_;
  Servo servo_;
  std::optional<ScalarSensor> voltmeter_;
  std::optional<ScalarSensor> thermometer_;
  DriveStateMachine state_;
  std::optional<std::uint16_t> leaving_by_;  // the controlword that takes effect at the end of a ramp
  PositionDemand demand_;
  bool target_given_ = false;    // since the motion restarted
  bool target_limited_ = false;  // the last one of a cyclic mode
  ProfilePosition profile_;
  Homing homing_;
  std::int32_t home_units_ = 0;  // what the bus counts less the encoder's position
  PositionWatch watch_;
  VelocityEstimate velocity_;
  double shown_current_A_ = 0.0;  // of which the values tell
  ServoMonitor monitor_;
  canopen::NodeDescription description_;
  DriveValues values_;
  canopen::NodeMemory<4, 4, 2, 8> memory_;
  canopen::DeviceServices services_;
  canopen::Node node_;
  NodeStorage storage_{node_};
  bool powered_ = false;
  bool hanging_ = false;
  bool started_ = false;
  bool enable_line_ = false;
  std::uint64_t start_us_ = 0;  // when the boot-up is due
  std::uint64_t now_us_ = 0;
  std::optional<std::uint64_t> last_sync_us_;
  BusOffPause bus_off_;
  CanopenFilter filter_;
};

}  // namespace koboshi::sim_board
