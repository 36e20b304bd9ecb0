// scenarios/low_supply.yaml: a robot whose battery runs empty sits down before its drives give up.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim_board/engine/mujoco/has_mujoco.h"
#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

using behaviour::Reason;
using behaviour::State;
using sim_board::Stepper;

constexpr std::uint8_t kController = 1;
constexpr std::uint16_t kUnderVoltage = 0x3220;
constexpr double kFallen_deg = 60.0;

simulation::Scenario low_supply(const std::vector<Override>& overrides = {},
                                Stepper stepper = Stepper::kLumped) {
  simulation::Scenario scenario =
      simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/low_supply.yaml", overrides);
  scenario.physics.stepper = stepper;
  return scenario;
}

double tilt_deg(const RobotRun& run) {
  return std::acos(run.board().world().body(0).X_WL.linear()(2, 2)) * 180.0 / std::numbers::pi;
}

double ahead_m(const RobotRun& run) { return run.board().world().body(0).X_WL.translation().x(); }

// Runs until then, and returns the greatest tilt of the trunk on the way.
double most_tilted_deg(RobotRun& run, std::uint64_t end_us) {
  double most = 0.0;
  while (run.now_us() < end_us) {
    run.run_until_us(run.now_us() + 10'000);
    most = std::max(most, tilt_deg(run));
  }
  return most;
}

std::size_t drive_emergencies(const RobotRun& run) {
  std::size_t count = 0;
  for (const sim_board::JointDescription& joint : run.robot().joints)
    count += run.emergencies(joint.drive.node_id, kUnderVoltage).size();
  return count;
}

class EmptyBattery : public testing::TestWithParam<Stepper> {
 protected:
  void SetUp() override {
    if (GetParam() == Stepper::kMujoco && !sim_board::has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  }
};

TEST_P(EmptyBattery, StepsToAStandAndSits) {
  RobotRun run(low_supply({}, GetParam()));
  run.run_until_us(12'000'000);
  ASSERT_EQ(run.behaviour().state, State::kWalking);
  const double before_m = ahead_m(run);
  ASSERT_TRUE(run.run_until(State::kSittingDown, 14'500'000));
  EXPECT_EQ(run.behaviour().reason, Reason::kSupplyLow);
  // At full speed until then.
  EXPECT_NEAR((ahead_m(run) - before_m) / (1e-6 * static_cast<double>(run.now_us() - 12'000'000)), 0.26,
              0.05);
  EXPECT_EQ(run.emergencies(kController, kUnderVoltage).size(), 0u);
  double most_deg = 0.0;
  while (run.behaviour().state == State::kSittingDown && run.now_us() < 20'000'000)
    most_deg = std::max(most_deg, most_tilted_deg(run, run.now_us() + 50'000));
  EXPECT_EQ(run.behaviour().state, State::kLimp);
  EXPECT_EQ(run.behaviour().reason, Reason::kSupplyLow);
  EXPECT_LT(most_deg, 30.0);
  EXPECT_EQ(run.emergencies(kController, kUnderVoltage).size(), 1u);
  EXPECT_EQ(drive_emergencies(run), 0u);
  // The battery is empty at 23 s; the robot sits on its feet, leans on its hands, and stays.
  EXPECT_LT(most_tilted_deg(run, 23'000'000), kFallen_deg);
  EXPECT_LT(std::abs(tilt_deg(run) - 42.0), 8.0);
  EXPECT_EQ(run.torque_count(), 0);
  EXPECT_EQ(run.behaviour().state, State::kLimp);
  EXPECT_EQ(run.behaviour().faults, 0);
  EXPECT_EQ(run.limited_ms(), 0u);
}

std::string stepper_name(const testing::TestParamInfo<Stepper>& info) {
  return info.param == Stepper::kMujoco ? "Mujoco" : "Lumped";
}

INSTANTIATE_TEST_SUITE_P(Engines, EmptyBattery, testing::Values(Stepper::kLumped, Stepper::kMujoco),
                         stepper_name);

// The same battery without the motion: the robot stands until its drives give up, and falls.
TEST(LowSupplyRun, StandsUntilTheDrivesGiveUpWithoutTheMotion) {
  RobotRun run(low_supply({{"motions", "[stand]"}}));
  ASSERT_TRUE(run.run_until(State::kLowBattery, 17'500'000));
  EXPECT_LT(tilt_deg(run), 10.0);
  ASSERT_TRUE(run.run_until(State::kFault, 21'500'000));
  EXPECT_EQ(run.behaviour().reason, Reason::kDriveFault);
  EXPECT_EQ(run.behaviour().drive_error_code, kUnderVoltage);
  EXPECT_GT(most_tilted_deg(run, 23'000'000), kFallen_deg);
}

// A supply that collapses while the robot sits down is a fault at once, as in any state.
TEST(LowSupplyRun, ABrownOutWhileSittingDownIsAFault) {
  RobotRun run(low_supply({{"faults",
                            "[{at_s: 5, kind: battery_discharge, open_circuit_V: 6.1}, "
                            "{at_s: 9, kind: battery_discharge, open_circuit_V: 3}]"}}));
  ASSERT_TRUE(run.run_until(State::kSittingDown, 8'900'000));
  run.run_until_us(9'040'000);
  EXPECT_EQ(run.behaviour().state, State::kFault);
  EXPECT_EQ(run.behaviour().drive_error_code, kUnderVoltage);
}

// 20 % less from the beginning, which is below the limit of the default robot.
std::vector<Override> weak(const std::string& parameters) {
  return {{"plant", "{battery.open_circuit_V: 6.08}"}, {"parameters", parameters}, {"faults", "[]"}};
}

TEST(LowSupplyRun, WalksWithTwentyPercentLessWithoutTheGuard) {
  RobotRun run(low_supply(weak("{lowest_supply_mV: 5500, low_supply_mV: 0}")));
  run.run_until_us(8'000'000);
  const double from_m = ahead_m(run);
  run.run_until_us(12'000'000);
  EXPECT_EQ(run.behaviour().state, State::kWalking);
  EXPECT_NEAR((ahead_m(run) - from_m) / 4.0, 0.26, 0.05);
}

TEST(LowSupplyRun, SitsWithTwentyPercentLessWithTheGuard) {
  RobotRun run(low_supply(weak("{lowest_supply_mV: 5500}")));
  EXPECT_LT(most_tilted_deg(run, 8'000'000), kFallen_deg);
  EXPECT_EQ(run.behaviour().state, State::kLimp);
  EXPECT_EQ(run.behaviour().reason, Reason::kSupplyLow);
}

// A battery with ten times the resistance, which the load draws below the limit.
class HighResistance : public testing::TestWithParam<int> {
 protected:
  static simulation::Scenario scenario() {
    return low_supply(
        {{"plant", "{battery.internal_resistance_ohm: 0.6, battery.open_circuit_V: 6.5}"},
         {"parameters", "{stalled_drive_sag_mV: " + std::to_string(GetParam()) + ", lowest_supply_mV: 5500}"},
         {"faults", "[]"}});
  }
};

TEST_P(HighResistance, IsLowOnlyIfTheLoadDoesNotExplainTheSag) {
  RobotRun run(scenario());
  const bool low = run.run_until(State::kSittingDown, 14'000'000);
  EXPECT_EQ(low, GetParam() == 0);
  EXPECT_EQ(run.behaviour().state, low ? State::kSittingDown : State::kWalking);
}

INSTANTIATE_TEST_SUITE_P(Sag, HighResistance, testing::Values(0, 822));

}  // namespace
}  // namespace koboshi::test
