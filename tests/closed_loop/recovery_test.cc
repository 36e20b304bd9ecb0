// scenarios/get_up.yaml and rise.yaml: the robot predicts its falls, reaches the ground and stands up.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim_board/world/foot.h"
#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

using behaviour::Reason;
using behaviour::State;

simulation::Scenario read(const std::string& name, const std::vector<Override>& overrides = {}) {
  simulation::Scenario scenario =
      simulation::read_scenario(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "scenarios" / name, overrides);
  scenario.physics.stepper = sim_board::Stepper::kLumped;
  return scenario;
}

double tilt_deg(const RobotRun& run) {
  return std::acos(run.board().world().body(0).X_WL.linear()(2, 2)) * 180.0 / std::numbers::pi;
}

// Returns true if any link other than a foot touches the ground.
bool lies(const RobotRun& run) {
  const auto feet = sim_board::feet_of(run.board().electronics().robot());
  for (const sim_board::Contact& contact : run.board().world().contacts()) {
    const bool foot = contact.link == feet[0]->link || contact.link == feet[1]->link;
    if (contact.other_link < 0 && !foot) return true;
  }
  return false;
}

TEST(Recovery, PredictsAFallToFrontAndBackAndGetsUp) {
  RobotRun run(read("get_up.yaml"));
  for (const Reason lying : {Reason::kProne, Reason::kSupine}) {
    ASSERT_TRUE(run.run_until(State::kFalling, run.now_us() + 20'000'000));
    EXPECT_FALSE(lies(run));
    EXPECT_LT(tilt_deg(run), 35.0);
    const std::uint64_t predicted_us = run.now_us();
    while (!lies(run)) run.run_until_us(run.now_us() + 1'000);
    EXPECT_GT(run.now_us() - predicted_us, 100'000u);
    ASSERT_TRUE(run.run_until(State::kFallen, run.now_us() + 1'000'000));
    run.run_until_us(run.now_us() + 20'000);
    EXPECT_EQ(run.torque_count(), 0);
    ASSERT_TRUE(run.run_until(State::kRising, run.now_us() + 5'000'000));
    EXPECT_EQ(run.behaviour().reason, lying);
    ASSERT_TRUE(run.run_until(State::kStanding, run.now_us() + 6'000'000));
    EXPECT_LT(tilt_deg(run), 10.0);
  }
  EXPECT_EQ(run.behaviour().faults, 0);
  // The robot walks again after it has stood up.
  ASSERT_TRUE(run.run_until(State::kWalking, 29'000'000));
  run.run_until_us(34'500'000);
  EXPECT_EQ(run.behaviour().state, State::kStanding);
  EXPECT_EQ(run.limited_ms(), 0u);
}

TEST(Recovery, RisesFromTheSeatAfterAFallToTheBack) {
  RobotRun run(
      read("get_up.yaml",
           {{"pushes", "[{at_s: 8, duration_s: 0.1, shape: half-sine, link: trunk, force_N: [-11, 0, 0]}]"},
            {"parameters.longest_standing_dcm_mm", "0"},  // a step would catch it
            {"commands", "[{at_s: 2, enable: true}]"}}));
  ASSERT_TRUE(run.run_until(State::kFalling, 9'000'000));
  ASSERT_TRUE(run.run_until(State::kRising, 13'000'000));
  EXPECT_EQ(run.behaviour().reason, Reason::kOnSeat);
  EXPECT_LT(tilt_deg(run), 53.0);
  ASSERT_TRUE(run.run_until(State::kStanding, run.now_us() + 6'000'000));
  EXPECT_EQ(run.behaviour().faults, 0);
  EXPECT_EQ(run.limited_ms(), 0u);
  EXPECT_LT(tilt_deg(run), 10.0);
}

constexpr const char* kLyingNames[] = {"Chest", "Back", "RightSide", "LeftSide"};

class RisesFrom : public testing::TestWithParam<const char*> {};

TEST_P(RisesFrom, WhereItLies) {
  RobotRun run(
      read("rise.yaml", {{"initial.attitude_deg", GetParam()}, {"parameters.attempts_to_get_up", "2"}}));
  run.run_until_us(3'100'000);
  EXPECT_GT(tilt_deg(run), 60.0);
  ASSERT_TRUE(run.run_until(State::kStanding, 14'000'000));
  run.run_until_us(run.now_us() + 500'000);
  EXPECT_EQ(run.behaviour().state, State::kStanding);
  EXPECT_EQ(run.limited_ms(), 0u);
  EXPECT_LT(tilt_deg(run), 10.0);
}

INSTANTIATE_TEST_SUITE_P(Recovery, RisesFrom,
                         testing::Values("{pitch: 90}", "{pitch: -90}", "{roll: 90}", "{roll: -90}"),
                         [](const auto& info) { return kLyingNames[info.index]; });

TEST(Recovery, EndsLimpInFaultWhenADriveDiesWhileItRises) {
  simulation::Scenario scenario = read("rise.yaml");
  simulation::Fault fault;
  fault.at_us = 4'200'000;
  fault.kind = simulation::Fault::Kind::kDrivePowerLoss;
  fault.target = {"left_knee", "a test", 0};
  scenario.faults.push_back(fault);
  RobotRun run(scenario);
  ASSERT_TRUE(run.run_until(State::kRising, 4'100'000));
  ASSERT_TRUE(run.run_until(State::kFault, 5'000'000));
  EXPECT_EQ(run.behaviour().reason, Reason::kDriveFault);
  run.run_until_us(run.now_us() + 400'000);
  EXPECT_EQ(run.torque_count(), 0);
}

}  // namespace
}  // namespace koboshi::test
