#include <gtest/gtest.h>

#include <numbers>

#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

using behaviour::State;

TEST(Squat, BootsLimpAndStandsUpOnCommandOnly) {
  RobotRun run(quick_squat());
  ASSERT_TRUE(run.run_until(State::kLimp, kEnable_us));
  run.run_until_us(kEnable_us);
  EXPECT_EQ(run.behaviour().state, State::kLimp);
  EXPECT_EQ(run.torque_count(), 0);
  EXPECT_FALSE(run.board().electronics().drive_enable_line());
  ASSERT_TRUE(run.run_until(State::kStanding, kRelease_us));
  EXPECT_EQ(run.torque_count(), 20);
}

// The limp legs drag their soles over the ground, where friction unloads the points that it acts on.
TEST(Squat, HangsLimpOnItsStandWithCoulombsFriction) {
  RobotRun run(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"));
  std::size_t touching_steps = 0;
  while (run.now_us() < 1'000'000) {
    run.run_until_us(run.now_us() + 1'000);
    if (!run.board().world().contacts().empty()) ++touching_steps;
  }
  EXPECT_GT(touching_steps, 500u);
  EXPECT_EQ(run.board().world().unsettled_steps(), 0u);
}

TEST(Squat, GoesDownByThreeCentimetresAndUpAgainWithoutFaults) {
  RobotRun run(quick_squat());
  run.run_until_us(3'400'000);
  ASSERT_EQ(run.behaviour().state, State::kMotion);
  const double up_m = run.board().world().body(0).X_WL.translation().z();
  run.run_until_us(4'530'000);  // the servos lag a little
  const double down_m = run.board().world().body(0).X_WL.translation().z();
  run.run_until_us(5'530'000);
  const double up_again_m = run.board().world().body(0).X_WL.translation().z();

  EXPECT_NEAR(up_m - down_m, 0.030, 0.003);
  EXPECT_NEAR(up_again_m, up_m, 0.003);
  const Eigen::Matrix3d R_WB = run.board().world().body(0).X_WL.linear();
  EXPECT_GT(R_WB(2, 2), std::cos(5.0 * std::numbers::pi / 180));  // the trunk is upright
  EXPECT_EQ(run.behaviour().faults, 0);
  EXPECT_EQ(run.limited_ms(), 0u);
  EXPECT_EQ(run.board().world().solver_warnings(), 0u);
  EXPECT_EQ(run.board().electronics().bus().usage().error_frames, 0u);
  EXPECT_EQ(run.board().electronics().bus().usage().collisions, 0u);
}

TEST(Squat, ReturnsToItsStartWhenStopped) {
  auto scenario = hanging_squat();
  scenario.commands.push_back({.at_us = 3'600'000, .kind = simulation::Command::Kind::kStop});
  RobotRun run(scenario);
  run.run_until_us(3'600'000);
  ASSERT_EQ(run.behaviour().state, State::kMotion);
  // The current squat takes two seconds, then half a second to the standing pose.
  EXPECT_FALSE(run.run_until(State::kStanding, 5'900'000));
  EXPECT_TRUE(run.run_until(State::kStanding, 6'100'000));
}

}  // namespace
}  // namespace koboshi::test
