#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hal/lockstep/batch.h"
#include "hal/port/period.h"
#include "sim_board/board/controller_host.h"
#include "sim_board/can/babbler.h"
#include "sim_board/can/bus.h"
#include "sim_board/can/bus_faults.h"
#include "sim_board/description/description.h"
#include "sim_board/drive/drive.h"
#include "sim_board/sensor/ankle_sensor.h"
#include "sim_board/sensor/imu.h"
#include "sim_board/sensor/sensor_node.h"
#include "sim_board/world/options.h"

namespace koboshi::sim_board {

struct BoardOptions {
  WorldOptions world;
  std::uint64_t seed = 1;
  double noise_scale = 1.0;               // scales all random errors of sensors and encoders
  std::uint64_t computing_time_us = 500;  // from a tick to its first frame
  std::uint64_t service_time_us = 50;     // the same for a service call without a tick
  bool sensors_on_bus = false;  // IMU and ankle sensors are CANopen nodes instead of the controller's own
};

// Wall time of each part of the board in seconds, estimated from samples. It depends on the machine and has
// no effect on a run.
struct TimeShares {
  double bus_s = 0.0;  // includes the drives' processing of frames
  double drives_s = 0.0;
  double firmware_s = 0.0;
  double physics_s = 0.0;
  double sensors_s = 0.0;
};

// Called before each physics step, to disturb the robot in it.
class StepListener {
 public:
  virtual void before_step(World& world, std::uint64_t start_us, std::uint64_t end_us) = 0;

 protected:
  ~StepListener() = default;
};

inline constexpr std::uint8_t kControllerNode = 1;
// COB-IDs of an operator's frames to the controller: its RPDO 1 (command, object 0x2000) and its RPDO 2
// (velocity of a walk, object 0x2110, in mm/s and mrad/s).
inline constexpr std::uint16_t kCommandIdentifier = 0x201;
inline constexpr std::uint16_t kVelocityIdentifier = 0x301;

// A CANopen node on the board's bus.
struct BusMember {
  std::uint8_t node_id = 0;
  NodeHandle handle{};
};

// The robot with all its electronics and the simulated clock: world, drives, sensors and bus on one side, the
// firmware's ports on the other. A process may contain several boards.
//
// Sequence of one millisecond: (1) the bus advances, each frame at its own microsecond; (2) the drives run
// their loops; (3) the firmware is serviced with the received frames, and its frames become ready after its
// computing time; (4) physics advances to the end of the millisecond together with supply, motors and gears;
// (5) the sensors sample.
class SimBoard {
 public:
  static constexpr std::uint64_t kService_us = hal::kServicePeriod_us;
  static constexpr std::uint64_t kTick_us = hal::kControlPeriod_us;
  static constexpr std::uint64_t kWatchdog_us = 500'000;
  static constexpr std::size_t kTransmitFifo = 32;  // capacity of each

  // Powers everything on at time zero. `robot` and `host` must outlive the board. Throws what make_world and
  // the sensors throw.
  SimBoard(const RobotDescription& robot, const BoardOptions& options, ControllerHost& host);
  SimBoard(const SimBoard&) = delete;
  SimBoard& operator=(const SimBoard&) = delete;

  // Advances one millisecond. Throws WorldBlewUp, and what the host throws.
  void advance();

  std::uint64_t now_us() const { return now_us_; }
  World& world() { return *world_; }
  const World& world() const { return *world_; }
  Bus& bus() { return bus_; }
  const Bus& bus() const { return bus_; }
  NodeHandle controller_bus_handle() const { return controller_; }
  // The controller, the drives in the order of their joints, and the sensors that are nodes.
  std::vector<BusMember> bus_members() const;
  hal::CanStatus controller_can_status() const { return bus_.status(controller_); }
  const RobotDescription& robot() const { return robot_; }
  const GroundDescription& ground() const { return options_.world.ground; }
  const Drive& drive(std::size_t joint) const { return *drives_[joint]; }
  // Null if the robot has none on this side.
  const AnkleSensor* ankle_sensor(hal::Side side) const {
    const auto& ankle = ankles_[static_cast<std::size_t>(side)];
    return ankle ? &*ankle : nullptr;
  }
  // Net energy that the servos have drawn from their supply since time zero.
  double drawn_J() const { return drawn_J_; }
  const TimeShares& time_shares() const { return shares_; }
  bool drive_enable_line() const { return enable_line_; }
  bool watchdog_bitten() const { return bitten_; }
  // Last input and output of the firmware; valid until the next `advance`.
  const hal::BatchInput& last_input() const { return input_; }
  const hal::BatchOutput& last_output() const { return output_; }

  // Null removes it. It must outlive the board or be removed before.
  void set_step_listener(StepListener* listener) { step_listener_ = listener; }
  // Sets the receiver of the SDO answers to the operator's PC. Null removes it, as above.
  void set_operator_listener(BusNode* listener) { operator_node_.listener = listener; }
  // Sends a frame from the operator's PC, an additional node on the bus. Returns false if its FIFO is full.
  bool send_as_operator(const hal::CanFrame& frame) { return bus_.queue(operator_, frame, now_us_); }

  // Saves or restores the whole board including the firmware, between two calls of `advance`. Nodes that a
  // test or tool has attached archive their own states. Throws as Bus::archive and the host do.
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
  void serve_controller();
  void watch_dog();
  void drive_servos();
  void step_physics();
  void step_world();
  void sample_sensors();

  const RobotDescription& robot_;
  const BoardOptions options_;
  ControllerHost& host_;
  std::uint64_t now_us_ = 0;
  std::unique_ptr<World> world_;
  std::uint64_t step_us_;
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
  std::vector<SupplyLoad> loads_;  // per servo, in this physics step
  double drawn_J_ = 0.0;
  StepListener* step_listener_ = nullptr;
  TimeShares shares_;
  std::uint64_t kicked_us_ = 0;
  bool enable_line_ = false;
  bool bitten_ = false;
  bool controller_stopped_ = false;
};

}  // namespace koboshi::sim_board
