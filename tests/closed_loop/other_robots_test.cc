// Robots with other sensors and other bodies than the default one stand and walk with the same firmware.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bus/can/sdo_transfer.h"
#include "simulation/model/bus_load.h"
#include "simulation/model/robot_model.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/reader.h"
#include "tests/closed_loop/other_robots.h"
#include "tests/closed_loop/pc.h"
#include "tests/closed_loop/run.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::test {
namespace {

using behaviour::State;

class OtherRobots : public testing::Test {
 protected:
  // The robot is released, stands, and walks forward from 4.2 s on.
  simulation::Scenario scenario(const std::string& robot, bool walks = true) {
    write_robot(folder_.path, robot, walks, /*fixed_upper_body=*/false);
    std::string text = "version: 1\nrobot: " + (folder_.path / "robot.sdf").string() +
                       "\nmotions: [stand]\nduration_s: 7.5\nseed: 1\nphysics: {stepper: lumped}\n";
    if (walks) {
      text +=
          "parameter_file: standing\ninitial:\n  held_until_s: 3.5\n  joints_deg: {hip_roll: 4, hip_pitch: "
          "-16, knee: 44, ankle_pitch: -28, ankle_roll: -4}\n";
    } else {
      text += "initial: {held_until_s: 3.5}\n";
    }
    text += "commands:\n  - {at_s: 2, enable: true}\n  - {at_s: 4.2, walk: {";
    text += walks ? "forward_m_per_s: 0.15}}\n" : "}}\n";
    const auto file = folder_.path / "go.yaml";
    write_file(file, text);
    return simulation::read_scenario(file);
  }

  TemporaryFolder folder_;
};

double height_of_up(const sim_board::SimBoard& board) { return board.world().body(0).X_WL.linear()(2, 2); }

std::int64_t read_number(Pc& pc, canopen::ObjectAddress address) {
  const std::vector<std::uint8_t> bytes = bus::SdoTransfer(pc, drive::kControllerNodeId).upload(address);
  if (bytes.size() == 1) return bytes[0];
  return static_cast<std::int16_t>(bytes.at(0) | bytes.at(1) << 8);
}

struct Walked {
  double forward_m = 0.0;
  double up = 0.0;
  std::vector<std::string> lost{};
  std::int64_t zmp_x = 0;  // 2011:05
  std::int64_t flags = 0;
  std::int64_t lost_bits = 0;
  double bus_load = 0.0;  // 0..1, the mean of the run
  double contacts = 0.0;  // share of the cycles of the walk in which the contact of a foot is the true one
};

Walked walk(const simulation::Scenario& scenario) {
  simulation::Simulation simulation(scenario);
  simulation::RunRecorder recorder(simulation, nullptr);
  Pc pc(simulation, drive::kControllerNodeId, [&] { recorder.record(); });
  pc.advance_until_us(4'100'000);
  const sim_board::SimBoard& board = simulation.board();
  EXPECT_EQ(recorder.telemetry().state, State::kStanding);
  const double weight_N = 9.80665 * simulation.robot().total_mass_kg();
  const double start_m = board.world().body(0).X_WL.translation().x();
  Walked walked{.zmp_x = read_number(pc, {0x2011, 5}),
                .flags = read_number(pc, {0x2011, 10}),
                .lost_bits = read_number(pc, {0x2201, 0})};
  int right = 0;
  int cycles = 0;
  while (simulation.board().now_us() < 7'500'000) {
    pc.advance_until_us(simulation.board().now_us() + 10'000);
    if (simulation.board().now_us() < 5'500'000) continue;
    for (std::size_t side = 0; side < 2; ++side, ++cycles) {
      const bool loaded = recorder.truth().foot_load_N[side] > weight_N / 12;
      right += recorder.telemetry().contact[side] == loaded ? 1 : 0;
    }
  }
  walked.contacts = static_cast<double>(right) / cycles;
  EXPECT_EQ(recorder.telemetry().state, State::kWalking);
  walked.forward_m = board.world().body(0).X_WL.translation().x() - start_m;
  walked.up = height_of_up(board);
  walked.lost = recorder.summary().lost_abilities;
  walked.bus_load = recorder.summary().can_bus_load;
  return walked;
}

constexpr std::int64_t kNoValue = -32768;

TEST_F(OtherRobots, WalksOnPressureCells) {
  const Walked walked = walk(scenario(with_pressure_cells(default_robot())));
  EXPECT_GT(walked.forward_m, 0.2);
  EXPECT_GT(walked.up, 0.98);
  EXPECT_GT(walked.contacts, 0.95);
  EXPECT_TRUE(walked.lost.empty());
  EXPECT_EQ(walked.lost_bits, 0);
  EXPECT_NE(walked.zmp_x, kNoValue);
  EXPECT_EQ(walked.flags & 0b111, 0b111);
}

TEST_F(OtherRobots, WalksOnContactSwitches) {
  const Walked walked = walk(scenario(with_contact_switches(default_robot())));
  EXPECT_GT(walked.forward_m, 0.2);
  EXPECT_GT(walked.up, 0.98);
  EXPECT_GT(walked.contacts, 0.92);
  EXPECT_THAT(walked.lost, testing::ElementsAre("zmp", "foot_loads"));
  EXPECT_EQ(walked.lost_bits, 0b11);
  EXPECT_EQ(walked.zmp_x, kNoValue);
  EXPECT_EQ(walked.flags & 0b11000111, 0b11000000);  // both feet are in contact, no ZMP is valid
}

TEST_F(OtherRobots, WalksWithoutAnySensorInItsFeet) {
  const Walked walked = walk(scenario(without_ankle_sensors(default_robot())));
  EXPECT_GT(walked.forward_m, 0.2);
  EXPECT_GT(walked.up, 0.98);
  EXPECT_GT(walked.contacts, 0.94);
  EXPECT_THAT(walked.lost, testing::ElementsAre("zmp", "foot_loads", "contact_sensing", "early_touchdown"));
  EXPECT_EQ(walked.lost_bits, 0b1111);
  EXPECT_EQ(walked.zmp_x, kNoValue);
  EXPECT_EQ(walked.flags & 0b11000111, 0b11000000);
}

// 23 joints; the unit is turned and in the chest, above the waist.
TEST_F(OtherRobots, WalksWithAWaistAndAnInertialUnitAboveIt) {
  const std::string robot =
      with_inertial_unit(with_waist(default_robot()), "chest", "0.01 -0.01 0.03 0.4 -0.3 1.2");
  const simulation::Scenario go = scenario(robot);
  const Walked walked = walk(go);
  EXPECT_GT(walked.forward_m, 0.2);
  EXPECT_GT(walked.up, 0.98);
}

// The measured load of the bus is the computed one. The start without heartbeats takes a twelfth of the run.
TEST_F(OtherRobots, WalksWith31Joints) {
  const Walked walked = walk(scenario(without_ankle_sensors(with_longer_arms(with_waist(default_robot())))));
  EXPECT_GT(walked.forward_m, 0.2);
  EXPECT_GT(walked.up, 0.98);
  const simulation::BusLoad computed = simulation::bus_load(31, /*sensors_on_bus=*/false);
  RecordProperty("bus_load", std::to_string(walked.bus_load));
  EXPECT_GT(walked.bus_load, 0.9 * computed.shortest);
  EXPECT_LT(walked.bus_load, computed.longest);
}

// 18 joints, with the parameters of the default robot, those of turning among them: they are not used. It
// stands, squats, steps on the spot, walks forward and to the left, and refuses to turn.
TEST_F(OtherRobots, WalksStraightWithoutHipYaw) {
  write_robot(folder_.path, without_hip_yaw(default_robot()), /*walks=*/true, /*fixed_upper_body=*/true);
  copy_motion(folder_.path, "squat");
  const auto file = folder_.path / "go.yaml";
  write_file(file, "version: 1\nrobot: " + (folder_.path / "robot.sdf").string() + R"(
motions: [stand, squat]
duration_s: 16.5
seed: 1
physics: {stepper: lumped}
parameter_file: standing
initial:
  held_until_s: 3.5
  joints_deg: {hip_roll: 4, hip_pitch: -16, knee: 44, ankle_pitch: -28, ankle_roll: -4}
commands:
  - {at_s: 2, enable: true}
  - {at_s: 4, play: squat}
  - {at_s: 6.5, stop: true}
  - {at_s: 9.5, walk: {}}
  - {at_s: 11, walk: {forward_m_per_s: 0.15}}
  - {at_s: 13, walk: {left_m_per_s: 0.06}}
  - {at_s: 16, walk: {turn_rad_per_s: 0.3}}
)");
  RobotRun run(simulation::read_scenario(file));
  EXPECT_EQ(run.robot().joints.size(), 18u);
  const auto place_m = [&]() -> Eigen::Vector3d { return run.board().world().body(0).X_WL.translation(); };
  run.run_until_us(4'000'000);
  EXPECT_EQ(run.behaviour().state, State::kStanding);
  const double standing_m = place_m().z();
  run.run_until_us(6'000'000);
  EXPECT_EQ(run.behaviour().state, State::kMotion);
  double lowest_m = place_m().z();
  while (run.board().now_us() < 9'400'000) {
    run.run_until_us(run.board().now_us() + 10'000);
    lowest_m = std::min(lowest_m, place_m().z());
  }
  EXPECT_EQ(run.behaviour().state, State::kStanding);
  EXPECT_LT(lowest_m, standing_m - 0.01);
  run.run_until_us(10'900'000);
  EXPECT_EQ(run.behaviour().state, State::kWalking);
  const double on_the_spot_m = place_m().x();
  run.run_until_us(12'900'000);
  EXPECT_GT(place_m().x(), on_the_spot_m + 0.15);
  run.run_until_us(13'400'000);
  const double aside_m = place_m().y();
  run.run_until_us(15'900'000);
  EXPECT_GT(place_m().y(), aside_m + 0.04);
  run.run_until_us(16'500'000);
  EXPECT_EQ(run.behaviour().state, State::kWalking);
  EXPECT_EQ(run.behaviour().refusal, behaviour::Reason::kVelocityOutOfRange);
  EXPECT_GT(height_of_up(run.board()), 0.98);
}

TEST_F(OtherRobots, StandsOnFourJointsAndRefusesToWalk) {
  RobotRun run(scenario(four_joints(), /*walks=*/false));
  EXPECT_EQ(run.robot().joints.size(), 4u);
  run.run_until_us(5'500'000);
  EXPECT_EQ(run.behaviour().state, State::kStanding);
  EXPECT_EQ(run.behaviour().refusal, behaviour::Reason::kNoLegs);
  EXPECT_GT(height_of_up(run.board()), 0.98);
}

}  // namespace
}  // namespace koboshi::test
