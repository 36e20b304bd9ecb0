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
#include "sim_board/robot/description.h"
#include "sim_board/sensor/ankle_sensor.h"
#include "sim_board/sensor/imu.h"
#include "sim_board/sensor/sensor_node.h"
#include "sim_board/servo/drive.h"
#include "sim_board/world/options.h"

namespace koboshi::sim {

struct BoardOptions {
  WorldOptions world;
  std::uint64_t seed = 1;
  double noise_scale = 1.0;               // of all random errors of sensors and encoders
  std::uint64_t computing_time_us = 500;  // from a tick to the first frame it sends
  std::uint64_t service_time_us = 50;     // the same of a service call without a tick
  bool sensors_on_bus = false;  // inertial unit and ankle sensors are CANopen nodes, not the controller's own
};

// Wall time that each part of the board has taken, in seconds, by samples. It depends on the machine and
// enters no run.
struct TimeShares {
  double bus_s = 0.0;  // with the drives' answers to frames
  double drives_s = 0.0;
  double firmware_s = 0.0;
  double physics_s = 0.0;
  double sensors_s = 0.0;
};

// Told before each physics step, to disturb the robot in it.
class StepListener {
 public:
  virtual void before_step(World& world, std::uint64_t start_us, std::uint64_t end_us) = 0;

 protected:
  ~StepListener() = default;
};

// The robot with all its electronics, and the owner of simulated time: world, drives, sensors and bus on one
// side, the ports of the firmware on the other. Several may live in one process.
//
// One millisecond: the bus is brought up to date, each frame at its own microsecond; the drives run their
// loops; the firmware is served with what has arrived, and what it sends is ready for the bus after its
// computing time; physics steps to the end of the millisecond, supply, motors and gears with it, and the
// sensors sample it.
class SimBoard {
 public:
  static constexpr std::uint64_t kService_us = hal::kServicePeriod_us;
  static constexpr std::uint64_t kTick_us = hal::kControlPeriod_us;
  static constexpr std::uint64_t kWatchdog_us = 500'000;
  static constexpr std::size_t kTransmitFifo = 32;  // each

  // Powers everything on at time zero. `robot` and `host` must outlive the board. Throws what make_world
  // and the sensors throw.
  SimBoard(const RobotDescription& robot, const BoardOptions& options, ControllerHost& host);
  SimBoard(const SimBoard&) = delete;
  SimBoard& operator=(const SimBoard&) = delete;

  // One millisecond. Throws WorldBlewUp, and what the host throws.
  void advance();

  std::uint64_t now_us() const { return now_us_; }
  World& world() { return *world_; }
  const World& world() const { return *world_; }
  Bus& bus() { return bus_; }
  const Bus& bus() const { return bus_; }
  NodeHandle controller_bus_handle() const { return controller_; }
  hal::CanStatus controller_can_status() const { return bus_.status(controller_); }
  const RobotDescription& robot() const { return robot_; }
  const GroundDescription& ground() const { return options_.world.ground; }
  const Drive& drive(std::size_t joint) const { return *drives_[joint]; }
  // Null where the robot has none.
  const AnkleSensor* ankle_sensor(hal::Side side) const {
    const auto& ankle = ankles_[static_cast<std::size_t>(side)];
    return ankle ? &*ankle : nullptr;
  }
  // What the servos have taken from their supply since time zero, less what they have given back to it.
  double drawn_J() const { return drawn_J_; }
  const TimeShares& time_shares() const { return shares_; }
  bool drive_enable_line() const { return enable_line_; }
  bool watchdog_bitten() const { return bitten_; }
  // What the firmware was last given and answered; valid until the next `advance`.
  const hal::BatchInput& last_input() const { return input_; }
  const hal::BatchOutput& last_output() const { return output_; }

  // Null for none. It must outlive the board or be taken away before.
  void set_step_listener(StepListener* listener) { step_listener_ = listener; }
  // Who hears what SDO servers answer to the operator's PC. Null for none, as above.
  void set_operator_listener(BusNode* listener) { operator_node_.listener = listener; }
  // Sends a frame from the operator's PC, a node of the bus beside the robot's own. False when its FIFO is
  // full.
  bool send_as_operator(const hal::CanFrame& frame) { return bus_.queue(operator_, frame, now_us_); }

  // Saves or restores everything on the board, the firmware included, between two calls of `advance`. Nodes
  // that a test or a tool has put on the bus keep their own states. Throws as Bus::archive and the host do.
  void archive(StateArchive& archive);

  // What breaks stays broken until it is mended.
  void hang_drive(std::size_t joint) { drives_[joint]->hang(); }
  void cut_drive_power(std::size_t joint) { drives_[joint]->power_off(); }
  // Power returns to a drive, or its own watchdog resets one that hangs.
  void restart_drive(std::size_t joint) { drives_[joint]->power_on(now_us_); }
  void break_encoder(std::size_t joint) { drives_[joint]->break_encoder(); }
  void overheat_drive(std::size_t joint) { drives_[joint]->overheat(); }
  // What a voltage regulator that fails leaves of the supply of all servos; none: what battery or robot file
  // give.
  void limit_supply(std::optional<double> highest_V) { highest_supply_V_ = highest_V; }
  void set_imu_running(bool running);
  void set_ankle_running(hal::Side side, bool running);
  void set_controller_running(bool running) { controller_stopped_ = !running; }
  void add_frame_fault(const FrameFault& fault);
  // Puts a further node on the bus; no state from before can be restored afterwards.
  void add_babbler(const Babble& babble) { babblers_.push_back(std::make_unique<Babbler>(bus_, babble)); }
  // Takes the controller off the bus, for a board that has none of its own.
  void unplug_controller() { bus_.power_off(controller_); }
  // Takes every node but the controller off the bus, so that nobody acknowledges its frames.
  void isolate_controller();
  // Puts them back.
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
  // Null where the robot has no such sensor, or the controller has it.
  std::unique_ptr<SensorNode> imu_node_;
  std::array<std::unique_ptr<SensorNode>, 2> ankle_nodes_;
  BusFaults bus_faults_;
  std::vector<std::unique_ptr<Babbler>> babblers_;
  std::optional<double> highest_supply_V_;
  std::vector<SupplyLoad> loads_;  // of each servo, in this physics step
  double drawn_J_ = 0.0;
  StepListener* step_listener_ = nullptr;
  TimeShares shares_;
  std::uint64_t kicked_us_ = 0;
  bool enable_line_ = false;
  bool bitten_ = false;
  bool controller_stopped_ = false;
};

}  // namespace koboshi::sim
