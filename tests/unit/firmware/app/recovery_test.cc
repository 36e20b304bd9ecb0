// From a predicted fall to standing, on a fake board. Tests the decisions, not the movement.

#include "tests/unit/firmware/app/recovery_fixture.h"

namespace koboshi::app {
namespace {

using motion::ExpectedAttitude;
using test::ControllerBench;
using test::kCountsPerG;

constexpr ExpectedAttitude kUprightAttitude{.up_B = {0, 0, 127}, .min_cosine = 28'378};  // tilt of at most 30
                                                                                         // degrees

TEST_F(RecoveryTest, LandsInThePoseOfItsDirectionAndGoesLimp) {
  stand();
  turn_to(0, 30);
  expect_state(State::kFalling, Reason::kFallPredicted);
  EXPECT_EQ(bench.now().motion, number_of(Role::kFallFront));
  EXPECT_TRUE(bench.board.drive_enable.enabled());
  turn_to(0, 65, 100);
  ASSERT_TRUE(bench.run_until(State::kFallen, 50));
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  EXPECT_EQ(bench.values().diagnosis.falls, 1);
}

// Only the deviation from a declared lean counts as a fall, if the parameters allow the declaration. A lean
// to the other side makes it worse.
TEST_F(RecoveryTest, MeasuresAFallFromTheDeclaredLean) {
  constexpr std::int16_t kTwentyDegrees = 3'641;
  const struct {
    motion::LeanDeclaration declared;
    double roll_deg, pitch_deg;  // where the trunk goes
    std::int16_t bound;
    bool falls;
  } kCases[] = {
      {{.pitch = kTwentyDegrees, .roll = 0}, 0, 32, 0, true},
      {{.pitch = kTwentyDegrees, .roll = 0}, 0, 32, kTwentyDegrees, false},
      {{.pitch = kTwentyDegrees, .roll = 0}, 0, 45, kTwentyDegrees, true},
      {{.pitch = 0, .roll = kTwentyDegrees}, 30, 0, 0, true},
      {{.pitch = 0, .roll = kTwentyDegrees}, 30, 0, kTwentyDegrees, false},
      {{.pitch = 0, .roll = -kTwentyDegrees}, -30, 0, kTwentyDegrees, false},
      {{.pitch = 0, .roll = -kTwentyDegrees}, 30, 0, kTwentyDegrees, true},
  };
  for (const auto& one : kCases) {
    SCOPED_TRACE(testing::Message() << one.declared.roll << " to " << one.roll_deg << ", " << one.pitch_deg);
    give(Role::kRollLeft, {one.declared.step(), {Opcode::kWait, 0, 300'000}, {Opcode::kWait, 0, 5'000'000}});
    ASSERT_EQ(pc.write({0x2140, 7}, one.bound, 2), canopen::AbortCode::kNone);
    stand();
    bench.command(Command::kPlay, number_of(Role::kRollLeft));
    ASSERT_EQ(bench.now().refusal, Reason::kNone);
    bench.run_ms(600);
    turn_to(one.roll_deg, one.pitch_deg, 400);
    EXPECT_EQ(bench.now().state, one.falls ? State::kFalling : State::kMotion);
    bench.command(Command::kLimp);
    turn_to(0, 0);
    bench.run_ms(500);
  }
}

TEST_F(RecoveryTest, StraightensUpAfterAPredictedFallThatDidNotHappen) {
  stand();
  turn_to(0, 28);
  EXPECT_EQ(bench.now().state, State::kFalling);
  turn_to(0, 20, 100);
  ASSERT_TRUE(bench.run_until(State::kSoftStart, 600));
  EXPECT_EQ(bench.now().reason, Reason::kCaughtItself);
  turn_to(0, 35, 100);  // falls after all
  EXPECT_TRUE(bench.run_until(State::kFalling, 100));
}

TEST_F(RecoveryTest, IsDownWhenItRestsOnItsSeat) {
  stand();
  turn_to(0, -50, 100);
  ASSERT_TRUE(bench.run_until(State::kFallen, 600));
  ASSERT_TRUE(bench.run_until(State::kRising, 600));
  EXPECT_EQ(bench.now().reason, Reason::kOnSeat);
  EXPECT_EQ(bench.now().motion, number_of(Role::kRiseSeat));
}

TEST_F(RecoveryTest, RisesFromChestAndBack) {
  const struct {
    double roll_deg, pitch_deg;
    Role falls, rises;
    Reason lies;
  } kCases[] = {{0, 90, Role::kFallFront, Role::kRiseProne, Reason::kProne},
                {0, -90, Role::kFallBack, Role::kRiseSupine, Reason::kSupine}};
  for (const auto& lying : kCases) {
    lie_limp_from_standing(lying.roll_deg, lying.pitch_deg);
    ASSERT_TRUE(bench.run_until(State::kRighting, 400));
    EXPECT_EQ(bench.now().attempts, 1);
    ASSERT_TRUE(bench.run_until(State::kRising, 100));
    EXPECT_EQ(bench.now().reason, lying.lies);
    EXPECT_EQ(bench.now().motion, number_of(lying.rises));
    turn_to(0, 0, 180);
    ASSERT_TRUE(bench.run_until(State::kSteadying, 100));
    ASSERT_TRUE(bench.run_until(State::kStanding, 400));
    EXPECT_EQ(bench.now().attempts, 0);
    bench.command(Command::kLimp);
    bench.run_ms(50);
  }
  EXPECT_EQ(bench.values().diagnosis.risen, 2);
}

// Drives that are enabled again must hold the pose in which the robot lies.
TEST_F(RecoveryTest, TargetsFollowLimpJoints) {
  constexpr std::size_t kKnee = 3;
  lie_limp_from_standing(0, 90);
  const auto bend_to = [this](double angle_deg) {
    bench.drives[kKnee].position =
        robot::drive_position(bench.model().joints[kKnee].drive, test::degrees(angle_deg));
  };
  bend_to(60);
  bench.run_ms(30);
  EXPECT_EQ(bench.now().state, State::kFallen);
  EXPECT_NEAR(fixed::to_double(bench.target(kKnee)) / test::kRadPerDegree, 60, 1e-3);
  for (test::DriveStub& drive : bench.drives) drive.enables = false;
  ASSERT_TRUE(bench.run_until(State::kRighting, 400));
  bend_to(50);
  bench.run_ms(30);
  EXPECT_EQ(bench.now().state, State::kRighting);
  EXPECT_NEAR(fixed::to_double(bench.target(kKnee)) / test::kRadPerDegree, 50, 1e-3);
}

// Motions of a fall and of a stand-up may soften joints; none of it is left once the robot stands.
TEST_F(RecoveryTest, StandsWithFullTorqueAfterSoftMotions) {
  constexpr motion::Stiffness kSoft{.percent = 40, .joints = (1u << 20) - 1};
  give(Role::kFallFront, {kSoft.step(), {Opcode::kWait, 0, 5'000'000}});
  give(Role::kRiseProne, {kSoft.step(), {Opcode::kWait, 0, 400'000}});
  const auto with_limit = [&](std::uint32_t permille) {
    return std::ranges::count_if(bench.drives,
                                 [&](auto& drive) { return drive.object(0x6072, 0) == permille; });
  };
  stand();
  turn_to(0, 60, 400);
  ASSERT_EQ(bench.now().state, State::kFalling);
  EXPECT_EQ(with_limit(400), 20) << "in the fall";
  turn_to(0, 90, 100);
  ASSERT_TRUE(bench.run_until(State::kFallen, 100));
  bench.run_ms(60);
  EXPECT_EQ(with_limit(1'000), 20) << "on the ground";
  ASSERT_TRUE(bench.run_until(State::kRising, 1'000));
  bench.run_ms(300);
  ASSERT_EQ(bench.now().state, State::kRising);
  EXPECT_EQ(with_limit(400), 20) << "in the stand-up";
  turn_to(0, 0, 180);
  ASSERT_TRUE(bench.run_until(State::kStanding, 1'000));
  bench.run_ms(60);
  EXPECT_EQ(with_limit(1'000), 20) << "standing";
  EXPECT_EQ(bench.values().diagnosis.risen, 1);
}

TEST_F(RecoveryTest, RollsOverFromASideFirst) {
  lie_limp_from_standing(-90, 0);
  ASSERT_TRUE(bench.run_until(State::kRolling, 500));
  EXPECT_EQ(bench.now().reason, Reason::kOnLeftSide);
  EXPECT_EQ(bench.now().motion, number_of(Role::kRollLeft));
  turn_to(0, 0, 100);
  turn_to(0, -90, 100);
  ASSERT_TRUE(bench.run_until(State::kRising, 100));
  EXPECT_EQ(bench.now().motion, number_of(Role::kRiseSupine));
  EXPECT_EQ(bench.now().attempts, 1);
}

TEST_F(RecoveryTest, TriesAgainSlowerAndGivesUpInFault) {
  lie_limp_from_standing(90, 0);  // stays on its right side regardless of the motion
  int rolling_ms = 0;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    ASSERT_TRUE(bench.run_until(State::kRolling, 600)) << attempt;
    EXPECT_EQ(bench.now().attempts, attempt);
    const std::uint64_t begun_us = bench.now_us();
    ASSERT_TRUE(bench.run_until(State::kFallen, 600));
    EXPECT_EQ(bench.now().reason, Reason::kRecoveryStepFailed);
    const int took_ms = static_cast<int>((bench.now_us() - begun_us) / 1'000);
    EXPECT_GT(took_ms, rolling_ms);
    rolling_ms = took_ms;
  }
  ASSERT_TRUE(bench.run_until(State::kFault, 400));
  EXPECT_EQ(bench.now().reason, Reason::kCannotGetUp);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  EXPECT_TRUE(bench.last_sent(0x081).has_value());
}

TEST_F(RecoveryTest, AbortsAMotionWhoseExpectationFails) {
  give(Role::kRiseProne, {kUprightAttitude.step(), {Opcode::kWait, 0, 5'000'000}});
  lie_limp_from_standing(0, 90);
  ASSERT_TRUE(bench.run_until(State::kRising, 500));
  ASSERT_TRUE(bench.run_until(State::kFallen, 230));
  EXPECT_EQ(bench.now().reason, Reason::kRecoveryStepFailed);
}

TEST_F(RecoveryTest, StandsOnlyOnceUprightAndAtRest) {
  lie_limp_from_standing(0, 90);
  ASSERT_TRUE(bench.run_until(State::kRising, 500));
  turn_to(0, 40, 150);
  ASSERT_TRUE(bench.run_until(State::kSteadying, 200));
  bench.run_ms(1'000);
  EXPECT_EQ(bench.now().state, State::kSteadying);
  ASSERT_TRUE(bench.run_until(State::kFallen, 2'100));
  expect_state(State::kFallen, Reason::kRecoveryStepFailed);
}

TEST_F(RecoveryTest, StandsAtOnceWhenHeldUpright) {
  lie_limp_from_standing(0, 90);
  turn_to(0, 0, 100);
  ASSERT_TRUE(bench.run_until(State::kSoftStart, 600));
  EXPECT_EQ(bench.now().reason, Reason::kHeldUpright);
  EXPECT_TRUE(bench.run_until(State::kStanding, 3'000));
}

TEST_F(RecoveryTest, WaitsUntilItRests) {
  lie_limp_from_standing(0, 90);
  for (int i = 0; i < 5; ++i) {
    turn_to(0, i % 2 == 0 ? 80 : 90, 100);
    EXPECT_EQ(bench.now().state, State::kFallen);
  }
  EXPECT_TRUE(bench.run_until(State::kRighting, 400));
}

TEST_F(RecoveryTest, GetsUpByCommandOnlyWhenLimp) {
  bench.command(Command::kGetUp);
  EXPECT_EQ(bench.now().state, State::kFallen);
  ASSERT_TRUE(bench.run_until(State::kStanding, 4'000));  // it was upright before
  bench.command(Command::kGetUp);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
}

TEST_F(RecoveryTest, StaysDownInFaultWithoutAttempts) {
  ASSERT_EQ(pc.write({0x2141, 1}, 0, 1), canopen::AbortCode::kNone);
  lie_limp_from_standing(0, -90);
  ASSERT_TRUE(bench.run_until(State::kFault, 400));
  EXPECT_EQ(bench.now().reason, Reason::kCannotGetUp);
}

TEST(RecoveryWithoutMotions, FallsAndStaysDownInFault) {
  ControllerBench bench;
  bench.run_ms(2'000);
  ASSERT_TRUE(bench.run_until_standing());
  bench.imu_sample.gyro_raw[1] = 4 * 1'878;
  ASSERT_TRUE(bench.run_until(State::kFalling, 200));
  ASSERT_TRUE(bench.run_until(State::kFallen, 300));
  bench.imu_sample.gyro_raw = {};
  bench.imu_sample.accelerometer_raw = {static_cast<std::int16_t>(-kCountsPerG), 0, 0};
  ASSERT_TRUE(bench.run_until(State::kFault, 1'000));
  EXPECT_EQ(bench.now().reason, Reason::kCannotGetUp);
}

TEST(RecoveryWithoutGyroBias, DetectsNoFalls) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  ASSERT_EQ(bench.values().diagnosis.gyro_calibrations, 0);
  bench.imu_sample.gyro_raw[1] = 4 * 1'878;
  bench.run_ms(500);
  EXPECT_EQ(bench.now().state, State::kStanding);
}

TEST(WithoutGyroBias, TheRobotDoesNotWalk) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  ASSERT_EQ(bench.values().diagnosis.gyro_calibrations, 0);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(bench.now().refusal, Reason::kGyroBiasUnknown);
  bench.command(Command::kLimp);
  bench.run_ms(2'000);
  ASSERT_TRUE(bench.run_until_standing());
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().state, State::kWalking);
}

}  // namespace
}  // namespace koboshi::app
