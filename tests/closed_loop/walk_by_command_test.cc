// scenarios/go.yaml: the robot walks at a commanded velocity.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/canopen/frame.h"
#include "simulation/observe/run_recorder.h"
#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

using behaviour::State;

simulation::Scenario go(const std::vector<Override>& overrides = {}) {
  simulation::Scenario scenario =
      simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/go.yaml", overrides);
  scenario.physics.stepper = sim_board::Stepper::kLumped;
  return scenario;
}

struct Place {
  Eigen::Vector2d p_m;
  double yaw_rad;
  double up;  // cosine of the trunk's tilt
};

Place place(const RobotRun& run) {
  const Eigen::Isometry3d X_WB = run.board().world().body(0).X_WL;
  return {X_WB.translation().head<2>(), std::atan2(X_WB.linear()(1, 0), X_WB.linear()(0, 0)),
          X_WB.linear()(2, 2)};
}

// Displacement between two poses, in the frame of the first heading: x forward, y left.
Eigen::Vector2d displacement_m(const Place& from, const Place& to) {
  return Eigen::Rotation2Dd(-from.yaw_rad) * (to.p_m - from.p_m);
}

TEST(WalkByCommand, WalksStraightThenACurveThenStands) {
  RobotRun run(go());
  run.run_until_us(3'900'000);
  ASSERT_EQ(run.behaviour().state, State::kStanding);
  run.run_until_us(7'000'000);
  ASSERT_EQ(run.behaviour().state, State::kWalking);
  const Place straight = place(run);
  run.run_until_us(12'000'000);
  const Place curve = place(run);
  const Eigen::Vector2d ahead_m = displacement_m(straight, curve);
  EXPECT_NEAR(ahead_m.x(), 5.0 * 0.15, 0.15);
  EXPECT_LT(std::abs(ahead_m.y()), 0.15);

  double turned_rad = 0.0;
  for (double yaw_rad = curve.yaw_rad; run.now_us() < 17'000'000;) {
    run.run_until_us(run.now_us() + 100'000);
    turned_rad += std::remainder(place(run).yaw_rad - yaw_rad, 2.0 * std::numbers::pi);
    yaw_rad = place(run).yaw_rad;
  }
  EXPECT_NEAR(turned_rad, 5.0 * 0.4, 0.45);

  ASSERT_TRUE(run.run_until(State::kStanding, 19'500'000));
  const Place stands = place(run);
  run.run_until_us(20'500'000);
  EXPECT_GT(place(run).up, std::cos(3.0 * std::numbers::pi / 180.0));
  EXPECT_LT(displacement_m(stands, place(run)).norm(), 3e-3);
  EXPECT_EQ(run.behaviour().faults, 0);
  EXPECT_EQ(run.behaviour().refusal, behaviour::Reason::kNone);
  EXPECT_EQ(run.limited_ms(), 0u);
  EXPECT_EQ(run.torque_count(), 20);
}

// An operator's command during a run has the same effect as the same command in the scenario.
TEST(WalkByCommand, ReplaysAnOperatorsCommands) {
  using Kind = simulation::Command::Kind;
  simulation::Scenario scenario = go();
  scenario.duration_us = 1'500'000;
  scenario.parameters = {{{"step_time_ms", scenario.file, 0}, 250.0}};
  scenario.commands = {{.at_us = 1'000'000, .kind = Kind::kStop}};
  simulation::Push push;
  push.duration_us = 100'000;
  push.link.text = "trunk";
  push.force_W_N = {3.0, -1.0, 0.0};
  const auto advance_until = [](simulation::Simulation& simulation, std::uint64_t end_us) {
    while (simulation.board().now_us() < end_us) simulation.advance();
  };
  simulation::Simulation operated(scenario);
  simulation::RunRecorder operated_recorder(operated, nullptr);
  operated.command({.kind = Kind::kReset});  // before the parameters are set
  advance_until(operated, 700'000);
  operated.command({.kind = Kind::kEnable});
  operated.push(push);
  advance_until(operated, 1'000'000);
  operated.command({.kind = Kind::kWalk, .velocity = {0.02, 0.0, -0.1}});
  advance_until(operated, 1'500'000);
  operated_recorder.record_tick();

  const simulation::Scenario played = operated.played();
  ASSERT_EQ(played.commands.size(), 4u);
  EXPECT_EQ(played.commands[2].kind, Kind::kStop);
  EXPECT_EQ(played.commands[3].at_us, 1'000'000u);
  ASSERT_EQ(played.pushes.size(), 1u);
  EXPECT_EQ(played.pushes[0].at_us, 700'000u);
  simulation::Simulation repeated(played);
  simulation::RunRecorder repeated_recorder(repeated, nullptr);
  advance_until(repeated, 1'500'000);
  repeated_recorder.record_tick();
  EXPECT_EQ(repeated_recorder.summary().state_hash, operated_recorder.summary().state_hash);
}

TEST(WalkByCommand, SendsTheVelocityBeforeTheCommand) {
  simulation::Scenario scenario = go();
  scenario.initial.release_us.reset();
  scenario.initial.fixed_base = true;
  scenario.commands = {{.at_us = 50'000,
                        .kind = simulation::Command::Kind::kWalk,
                        .motion = 0,
                        .velocity = {0.15, -0.02, 0.4}}};
  RobotRun run(scenario);
  run.run_until_us(60'000);
  std::vector<hal::CanFrame> told;
  for (const RobotRun::Frame& frame : run.frames()) {
    if (frame.frame.identifier == 0x201 || frame.frame.identifier == 0x301) told.push_back(frame.frame);
  }
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0],
            (hal::CanFrame{.identifier = 0x301, .size = 6, .data = {150, 0, 0xEC, 0xFF, 0x90, 0x01}}));
  EXPECT_EQ(told[1].identifier, 0x201);
  EXPECT_EQ(told[1].size, 3);
  EXPECT_EQ(told[1].data[0], 7);
}

TEST(WalkByCommand, EndsWhenTheBatteryIsLow) {
  RobotRun run(go({{"faults", "[{at_s: 7, kind: supply_drop, supply_V: 6.2}]"}}));
  run.run_until_us(8'500'000);
  EXPECT_EQ(run.behaviour().state, State::kWalking);
  run.run_until_us(13'000'000);
  EXPECT_EQ(run.behaviour().state, State::kLowBattery);
  EXPECT_GT(place(run).up, 0.98);
}

}  // namespace
}  // namespace koboshi::test
