#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hal/lockstep/batch.h"
#include "hal/port/period.h"
#include "sim_board/board/board_options.h"
#include "sim_board/board/controller_host.h"
#include "sim_board/board/tick_clock.h"
#include "sim_board/board/time_shares.h"
#include "sim_board/can/babbler.h"
#include "sim_board/can/bus.h"
#include "sim_board/can/bus_faults.h"
#include "sim_board/description/description.h"
#include "sim_board/drive/drive.h"
#include "sim_board/sensor/ankle_sensor.h"
#include "sim_board/sensor/imu.h"
#include "sim_board/sensor/sensor_node.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// COB-IDs of an operator's frames to the controller: its RPDO 1 (command, object 0x2000) and its RPDO 2
// (velocity of a walk, object 0x2110, in mm/s and mrad/s).
inline constexpr std::uint16_t kCommandIdentifier = 0x201;
inline constexpr std::uint16_t kVelocityIdentifier = 0x301;

// A CANopen node on the board's bus.
struct BusMember {
  std::uint8_t node_id = 0;
  NodeHandle handle{};
};

// The electronics of one robot in a world: its bus with drives and sensors on one side, the ports of its
// firmware on the other. Whoever has the clock and the world, of which this robot may be one of several,
// calls
//   serve(), and then for each physics step drive_servos(), World::step(), sample().
class Electronics {  // Large: one member per part that a robot carries
 public:
  static constexpr std::uint64_t kService_us = hal::kServicePeriod_us;
  static constexpr std::uint64_t kTick_us = hal::kControlPeriod_us;
  static constexpr std::uint64_t kWatchdog_us = 500'000;
  static constexpr std::size_t kTransmitFifo = 32;  // capacity of each

  // Powers everything on at time zero. All arguments but the options must outlive this object. Throws what
  // the sensors throw.
  Electronics(const RobotDescription& robot, const BoardOptions& options, World& world, ControllerHost& host,
              TimeShares& shares);
  Electronics(const Electronics&) = delete;
  Electronics& operator=(const Electronics&) = delete;

  // One millisecond: gather(), respond().
  void serve() {
    gather();
    respond();
  }
  // (1) The bus advances, each frame at its own microsecond; (2) the drives run their loops; (3) the input of
  // the firmware is complete: see last_input().
  void gather();
  // The firmware is serviced with this input, and its frames become ready after its computing time. Throws
  // what the host throws.
  void respond();
  // Sets the torques of the motors for the next physics step, by their supply and gears.
  void drive_servos();
  // The sensors sample the world, in which it is now this time.
  void sample(std::uint64_t now_us);

  Bus& bus() { return bus_; }
  const Bus& bus() const { return bus_; }
  NodeHandle controller_bus_handle() const { return controller_; }
  // The controller, the drives in the order of their joints, and the sensors that are nodes.
  std::vector<BusMember> bus_members() const;
  hal::CanStatus controller_can_status() const { return bus_.status(controller_); }
  const RobotDescription& robot() const { return robot_; }
  const Drive& drive(std::size_t joint) const { return *drives_[joint]; }
  // The six-axis sensor of this side; null if the robot has none.
  const AnkleSensor* ankle_sensor(hal::Side side) const {
    const auto& ankle = ankles_[static_cast<std::size_t>(side)];
    return ankle && ankle->kind() == hal::AnkleKind::kSixAxis ? &*ankle : nullptr;
  }
  // Net energy that the servos have drawn from their supply since time zero.
  double drawn_J() const { return drawn_J_; }
  bool drive_enable_line() const { return enable_line_; }
  bool watchdog_bitten() const { return bitten_; }
  // Input of the firmware's last service call; valid until the next `serve`. Between gather() and respond()
  // it is the input of the call to come.
  const hal::BatchInput& last_input() const { return input_; }

  // Sets the receiver of the SDO answers to the operator's PC. Null removes it.
  // It must outlive this object or be removed before.
  void set_operator_listener(BusNode* listener) { operator_node_.listener = listener; }
  // Sends a frame from the operator's PC, an additional node on the bus. Returns false if its FIFO is full.
  bool send_as_operator(const hal::CanFrame& frame) { return bus_.queue(operator_, frame, now_us_); }

  // Saves or restores everything including the firmware, between two calls of `serve`. Nodes that a test or
  // tool has attached archive their own states. Throws as Bus::archive and the host do.
  void archive(StateArchive& archive);

  // Faults; each lasts until it is reverted.
  void hang_drive(std::size_t joint) { drives_[joint]->hang(); }
  void cut_drive_power(std::size_t joint) { drives_[joint]->power_off(); }
  // Restores a drive's power, or resets a hanging drive as its own watchdog does.
  void restart_drive(std::size_t joint) { drives_[joint]->power_on(now_us_); }
  void break_encoder(std::size_t joint) { drives_[joint]->break_encoder(); }
  void overheat_drive(std::size_t joint) { drives_[joint]->overheat(); }
  // Limits the supply of all servos, as a failing voltage regulator does. Empty: the voltage of the battery
  // or the robot file.
  void limit_supply(std::optional<double> highest_V) { highest_supply_V_ = highest_V; }
  // Discharges the battery: from now on its open-circuit voltage goes linearly to `open_circuit_V`, within
  // `over_us`, and stays there. The robot must have a battery.
  void discharge_battery(double open_circuit_V, std::uint64_t over_us);
  // Adds a rate to what the gyro senses, in the axes of its link, until it is changed.
  void add_gyro_rate(const Eigen::Vector3d& w_L_rad_per_s) {
    if (imu_) imu_->add_rate(w_L_rad_per_s);
  }
  void set_imu_running(bool running);
  void set_ankle_running(hal::Side side, bool running);
  void set_controller_running(bool running) { controller_stopped_ = !running; }
  void add_frame_fault(const FrameFault& fault);
  // Attaches another node to the bus; earlier saved states can then no longer be restored.
  void add_babbler(const Babble& babble) { babblers_.push_back(std::make_unique<Babbler>(bus_, babble)); }
  // Disconnects the controller from the bus, for a board without one.
  void unplug_controller() { bus_.power_off(controller_); }
  // Disconnects every node but the controller, so that its frames are not acknowledged.
  void isolate_controller();
  // Reconnects these nodes.
  void rejoin_controller();

 private:
  // The controller's CAN receiver: a ring that the firmware empties in each service call.
  class Receiver final : public BusNode {
   public:
    explicit Receiver(hal::BatchInput& input) : input_(input) {}
    void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;

   private:
    hal::BatchInput& input_;
  };
  struct Operator final : BusNode {
    void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override {
      if (listener != nullptr) listener->on_frame(frame, time_us);
    }
    BusNode* listener = nullptr;
  };

  void advance_bus();
  void update_drives();
  void collect_samples();
  void attach_sensor_nodes();
  void take(const hal::ImuSample& sample);
  void take(hal::Side side, const hal::AnkleSample& sample);
  void update_sensor_nodes();
  void complete_input();
  void serve_controller();
  void watch_dog();
  double open_circuit_V() const;

  // The open-circuit voltage of the battery, linear in time; constant before and after.
  struct Discharge {
    double from_V = 0.0;
    double to_V = 0.0;
    std::uint64_t from_us = 0;
    std::uint64_t over_us = 0;
  };

  const RobotDescription& robot_;
  const BoardOptions options_;
  World& world_;
  ControllerHost& host_;
  TimeShares& shares_;
  std::uint64_t now_us_ = 0;
  TickClock tick_clock_;
  hal::BatchInput input_;
  hal::BatchOutput output_;
  Bus bus_;
  Receiver receiver_{input_};
  Operator operator_node_;
  NodeHandle controller_;
  NodeHandle operator_;
  std::vector<std::unique_ptr<Drive>> drives_;
  std::optional<Battery> battery_;
  std::optional<Imu> imu_;
  std::array<std::optional<AnkleSensor>, 2> ankles_;
  // Null if the robot lacks the sensor or the controller reads it directly.
  std::unique_ptr<SensorNode> imu_node_;
  std::array<std::unique_ptr<SensorNode>, 2> ankle_nodes_;
  BusFaults bus_faults_;
  std::vector<std::unique_ptr<Babbler>> babblers_;
  std::optional<double> highest_supply_V_;
  std::optional<Discharge> discharge_;
  std::vector<SupplyLoad> loads_;  // per servo, in this physics step
  double drawn_J_ = 0.0;
  std::uint64_t kicked_us_ = 0;
  bool enable_line_ = false;
  bool bitten_ = false;
  bool controller_stopped_ = false;
};

}  // namespace koboshi::sim_board
