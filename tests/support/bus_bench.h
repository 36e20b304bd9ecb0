#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/app/controller.h"
#include "firmware/canopen/emergency.h"
#include "hal/fake/storage.h"
#include "hal/lockstep/batch_board.h"
#include "sim_board/can/babbler.h"
#include "sim_board/can/bus.h"
#include "sim_board/drive/drive.h"

namespace koboshi::test {

// Controllers and the drives of the test robot on one simulated bus with frame timing, without physics: each
// shaft follows its drive's demand exactly, and the robot hangs upright at rest.
//
//   BusBench bench;
//   ASSERT_TRUE(bench.run_until_standing());
//   bench.add_babbler({.frame = {.identifier = 0x601, .size = 8}});
//   bench.run_ms(1'000);
//   EXPECT_EQ(bench.controller().state(), behaviour::State::kStanding);
//
class BusBench final : private sim_board::BusObserver {
 public:
  struct SeenFrame {
    hal::CanFrame frame;
    std::uint64_t start_us;
    std::uint64_t end_us;
  };

  // A controller and its board. The firmware is serviced each millisecond of the controller's own clock.
  class Unit final : private sim_board::BusNode {
   public:
    Unit(sim_board::Bus& bus, double clock_rate);

    const app::ControllerValues& values() const { return controller_.values(); }
    behaviour::State state() const { return values().behaviour.state; }
    bool drive_enable_line() const { return output_.drive_enabled; }
    sim_board::NodeHandle handle() const { return handle_; }
    // Bus time of the next service call, in microseconds.
    std::uint64_t next_us() const;
    void serve(std::uint64_t now_us);

    bool runs = true;  // false: the firmware has stopped

   private:
    void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;
    void feed_sensors();

    sim_board::Bus& bus_;
    sim_board::NodeHandle handle_;
    double clock_rate_;
    std::uint64_t begin_us_;
    std::uint64_t services_ = 0;
    hal::FakeStorage storage_{128, 2048};
    hal::BatchBoard board_;
    app::Controller controller_;
    hal::BatchInput input_;
    hal::BatchOutput output_;
  };

  // `clock_rate` is the rate of the controller's clock relative to that of the bus and the drives.
  explicit BusBench(double clock_rate = 1.0);
  ~BusBench() { bus.set_observer(nullptr); }

  void run_ms(int duration_ms) { run_until_us(now_us_ + static_cast<std::uint64_t>(duration_ms) * 1'000); }
  // Returns false if the first controller has not reached `state` after `limit_ms`.
  bool run_until(behaviour::State state, int limit_ms = 3'000);
  // Boots and enables the robot and waits until it stands.
  bool run_until_standing();

  Unit& controller(std::size_t number = 0) { return *units_[number]; }
  // Powers on a second master: a controller identical to the first.
  Unit& add_controller() { return *units_.emplace_back(std::make_unique<Unit>(bus, 1.0)); }
  // Powers on an additional drive with the node id and identity of the drive of `like_joint`, but with this
  // serial number.
  sim_board::Drive& add_drive(std::size_t like_joint, std::uint32_t serial_number);
  sim_board::Drive& drive(std::size_t number) { return *drives_[number]->drive; }
  std::size_t drive_count() const { return drives_.size(); }
  int count_in(canopen::cia402::State state) const;
  void add_babbler(const sim_board::Babble& babble) {
    babblers_.push_back(std::make_unique<sim_board::Babbler>(bus, babble));
  }
  // Sends a frame from a PC.
  void say(const hal::CanFrame& frame);
  void command(behaviour::Command command, std::int16_t argument = 0);

  std::uint64_t now_us() const { return now_us_; }
  const robot::RobotModel& model() const { return model_; }
  // Returns the emergency codes that a node sent since `seen` was cleared, without error resets.
  std::vector<std::uint16_t> emergencies(std::uint8_t node_id) const;
  std::vector<SeenFrame> seen_with(std::uint16_t identifier) const;

  // --- State for tests to inspect ---
  sim_board::Bus bus;
  std::vector<SeenFrame> seen;  // all frames on the bus; tests may clear it

 private:
  struct Joint {
    sim_board::JointDescription description;
    sim_board::JointState shaft;
    std::unique_ptr<sim_board::Drive> drive;
  };
  struct Pc final : sim_board::BusNode {
    void on_frame(const hal::CanFrame&, std::uint64_t) override {}
  };

  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  void run_until_us(std::uint64_t end_us);
  void update_drives();

  robot::RobotModel model_;
  std::vector<std::unique_ptr<Unit>> units_;
  std::vector<std::unique_ptr<Joint>> drives_;
  std::vector<std::unique_ptr<sim_board::Babbler>> babblers_;
  Pc pc_;
  sim_board::NodeHandle pc_handle_;
  std::uint64_t now_us_ = 0;
  std::uint64_t drives_due_us_ = 0;
};

}  // namespace koboshi::test
