#include "sim_board/board/sim_board.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

// In place of the firmware: keeps what it was given and answers what the test says.
class ScriptedHost final : public ControllerHost {
 public:
  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override {
    inputs.push_back(input);
    output = {};
    output.watchdog_kicked = kicks;
    output.drive_enabled = line;
    if (answer) answer(input, output);
  }
  void archive(StateArchive& archive) override { archive(inputs, kicks, line); }

  std::vector<hal::BatchInput> inputs;
  bool kicks = true;
  bool line = false;
  std::function<void(const hal::BatchInput&, hal::BatchOutput&)> answer;
};

class FrameLog final : public BusObserver {
 public:
  struct Item {
    hal::CanFrame frame;
    std::uint64_t start_us;
  };
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t) override {
    items.push_back({frame, start_us});
  }
  std::vector<Item> items;
};

// A hinge on a stand, with an inertial unit in its bearing and one drive, node 16.
class SimBoardTest : public testing::Test {
 protected:
  SimBoardTest() {
    robot.joints[0].drive.node_id = 16;
    robot.joints[0].max_speed_rad_per_s = 7.48;
    ImuDescription imu;
    imu.link = 0;
    imu.gyro.range = 17.45;
    imu.gyro.resolution = 17.45 / 32768;
    imu.accelerometer.range = 39.2;
    imu.accelerometer.resolution = 39.2 / 32768;
    robot.imu = imu;
    options.world.fixed_base = true;
    options.world.ground.present = false;
    make();
  }
  void make() {
    board.emplace(robot, options, host);
    board->electronics().bus().set_observer(&log);
  }
  void run_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i) board->advance();
  }

  RobotDescription robot = sample_hinge({});
  BoardOptions options;
  ScriptedHost host;
  FrameLog log;
  std::optional<SimBoard> board;
};

TEST_F(SimBoardTest, SuppliesItsDrivesFromABatteryOrIndividually) {
  run_ms(5);
  EXPECT_EQ(board->electronics().drive(0).values().supply_mV, 7500u);
  robot.battery = {.open_circuit_V = 8.1, .internal_resistance_ohm = 0.2};
  make();
  run_ms(5);
  EXPECT_EQ(board->electronics().drive(0).values().supply_mV, 8100u);
}

TEST_F(SimBoardTest, DischargesItsBatteryLinearlyInTime) {
  robot.battery = {.open_circuit_V = 8.0, .internal_resistance_ohm = 0.2};
  make();
  const auto supply_mV = [&] { return static_cast<int>(board->electronics().drive(0).values().supply_mV); };
  run_ms(5);
  board->electronics().discharge_battery(7.0, 100'000);
  run_ms(50);
  EXPECT_NEAR(supply_mV(), 7'500, 20);                   // 10 mV a millisecond
  board->electronics().discharge_battery(7.2, 100'000);  // from where it is
  run_ms(50);
  EXPECT_NEAR(supply_mV(), 7'350, 20);
  run_ms(60);
  EXPECT_EQ(supply_mV(), 7'200);
  board->electronics().discharge_battery(6.0, 0);
  run_ms(3);
  EXPECT_EQ(supply_mV(), 6'000);
}

TEST_F(SimBoardTest, RunsServicesEachMillisecondAndTicksEachTenth) {
  run_ms(25);
  ASSERT_EQ(host.inputs.size(), 25u);
  for (std::size_t i = 0; i < host.inputs.size(); ++i) {
    EXPECT_EQ(host.inputs[i].now_us, 1'000 * i);
    EXPECT_EQ(host.inputs[i].tick, i % 10 == 0);
  }
  EXPECT_EQ(board->now_us(), 25'000u);
}

TEST_F(SimBoardTest, BehavesTheSameForAnyPhysicsStep) {
  run_ms(25);
  const auto coarse = host.inputs;
  host.inputs.clear();
  options.world.step_s = 0.00025;
  make();
  run_ms(25);
  ASSERT_EQ(host.inputs.size(), coarse.size());
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    EXPECT_EQ(host.inputs[i].now_us, coarse[i].now_us);
    EXPECT_EQ(host.inputs[i].imu.size, coarse[i].imu.size);
  }
}

TEST_F(SimBoardTest, SendsTheFramesOfATickAfterItsComputingTime) {
  host.answer = [](const hal::BatchInput& input, hal::BatchOutput& output) {
    if (input.now_us == 10'000 || input.now_us == 15'000)
      static_cast<void>(output.frames.push({.identifier = 0x123}));
  };
  run_ms(20);
  ASSERT_EQ(log.items.size(), 2u);
  EXPECT_EQ(log.items[0].start_us, 10'500u);
  EXPECT_EQ(log.items[1].start_us, 15'050u);
}

TEST_F(SimBoardTest, DeliversTheBootUpOfDrives) {
  run_ms(60);
  std::vector<hal::CanFrame> received;
  for (const auto& input : host.inputs) {
    for (const auto& frame : input.frames.view()) received.push_back(frame);
  }
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0], (hal::CanFrame{.identifier = 0x710, .size = 1, .data = {0}}));
}

TEST_F(SimBoardTest, ReceivesFramesFromAnOperator) {
  run_ms(5);
  ASSERT_TRUE(board->electronics().send_as_operator({.identifier = 0x201, .size = 3, .data = {1}}));
  run_ms(2);
  ASSERT_EQ(host.inputs.back().frames.size, 1);
  EXPECT_EQ(host.inputs.back().frames.items[0].identifier, 0x201);
}

TEST_F(SimBoardTest, DeliversOneInertialSampleEachMillisecondUntilTheUnitStops) {
  run_ms(10);
  std::size_t samples = 0;
  for (const auto& input : host.inputs) samples += input.imu.size;
  EXPECT_NEAR(static_cast<double>(samples), 9.0, 1.0);  // one sample of delay
  EXPECT_NEAR(host.inputs.back().imu.items[0].accelerometer_raw[2], 9.80665 / 39.2 * 32768, 100);
  board->electronics().set_imu_running(false);
  run_ms(2);
  host.inputs.clear();
  run_ms(10);
  for (const auto& input : host.inputs) EXPECT_EQ(input.imu.size, 0);
}

TEST_F(SimBoardTest, SetsTheDriveEnableLineAsCommanded) {
  run_ms(5);
  EXPECT_FALSE(board->electronics().drive_enable_line());
  host.line = true;
  run_ms(1);
  EXPECT_TRUE(board->electronics().drive_enable_line());
  host.line = false;
  run_ms(1);
  EXPECT_FALSE(board->electronics().drive_enable_line());
}

TEST_F(SimBoardTest, LatchesTheLineLowWhenTheWatchdogExpires) {
  host.line = true;
  run_ms(10);
  host.kicks = false;
  run_ms(499);
  EXPECT_TRUE(board->electronics().drive_enable_line());
  run_ms(2);
  EXPECT_TRUE(board->electronics().watchdog_bitten());
  EXPECT_FALSE(board->electronics().drive_enable_line());
  host.kicks = true;
  run_ms(10);
  EXPECT_FALSE(board->electronics().drive_enable_line());
}

TEST_F(SimBoardTest, CountsFramesLostByAStoppedFirmware) {
  board->electronics().set_controller_running(false);
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 10; ++j) ASSERT_TRUE(board->electronics().send_as_operator({.identifier = 0x7FF}));
    run_ms(1);
  }
  EXPECT_TRUE(host.inputs.empty());
  EXPECT_GT(board->electronics().last_input().can_status.receive_overruns, 0);
  EXPECT_EQ(board->electronics().last_input().frames.size, hal::BatchInput::kMaxFrames);
}

TEST_F(SimBoardTest, LeavesTheControllerAloneOnTheBus) {
  host.answer = [](const hal::BatchInput& input, hal::BatchOutput& output) {
    if (input.tick) static_cast<void>(output.frames.push({.identifier = 0x080}));
  };
  board->electronics().isolate_controller();
  run_ms(30);
  EXPECT_TRUE(log.items.empty());
  EXPECT_EQ(host.inputs.back().can_status.state, hal::CanErrorState::kErrorPassive);

  board->electronics().rejoin_controller();
  run_ms(20);
  EXPECT_FALSE(log.items.empty());
  EXPECT_EQ(host.inputs.back().can_status.state, hal::CanErrorState::kErrorActive);
}

TEST_F(SimBoardTest, KeepsADeadDriveOffTheBusAfterTheControllerRejoins) {
  board->electronics().cut_drive_power(0);
  board->electronics().isolate_controller();
  board->electronics().rejoin_controller();
  EXPECT_FALSE(board->electronics().bus().powered(board->electronics().drive(0).bus_handle()));
  board->electronics().restart_drive(0);
  EXPECT_TRUE(board->electronics().bus().powered(board->electronics().drive(0).bus_handle()));
}

}  // namespace
}  // namespace koboshi::sim_board
