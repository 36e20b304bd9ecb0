// Reactions of the walker to sensor readings.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/firmware/walk/walking_robot.h"

namespace koboshi::walk {
namespace {

using fixed::Angle;
using fixed::AngularRate;
using fixed::Force;
using fixed::from_double;
using fixed::to_double;
using hal::Side;
using test::rigid;
using test::WalkingRobot;

constexpr double kComHeight_m = 0.17;
constexpr double kTimeConstant_s = 0.13166;  // sqrt(z / g)
constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;

Observation leaning(double roll_rad, double pitch_rad) {
  Observation seen;
  seen.roll = from_double<Angle>(roll_rad);
  seen.pitch = from_double<Angle>(pitch_rad);
  return seen;
}

Observation turning(double y_rad_per_s, double z_rad_per_s) {
  Observation seen;
  seen.rates = {{}, from_double<AngularRate>(y_rad_per_s), from_double<AngularRate>(z_rad_per_s)};
  return seen;
}

// Returns the displacement of a landing relative to stepping on the spot, when the walker observes `seen`
// during the whole step.
test::Point shift(const WalkParameters& parameters, Side side, const Observation& seen) {
  WalkingRobot robot(parameters);
  for (int step = 0; step < 4; ++step) EXPECT_TRUE(robot.advance_until_landing());
  while (robot.landings.back().side == side) EXPECT_TRUE(robot.advance_until_landing());
  const test::Point before = robot.landings[robot.landings.size() - 2].p;  // the same foot's last
  EXPECT_TRUE(robot.advance_until_landing({}, seen));
  EXPECT_EQ(robot.landings.back().side, side);
  return robot.landings.back().p - before;
}

// Parameters with single support only, so that a foothold moves exactly by the capture term.
WalkParameters capturing(std::int16_t ahead, std::int16_t aside) {
  WalkParameters parameters = rigid();
  parameters.step.double_support = 0;
  parameters.reaction.capture_forward = ahead;
  parameters.reaction.capture_lateral = aside;
  parameters.reaction.dead_band = 50;
  parameters.reaction.smoothing = 0;
  return parameters;
}

// Remaining share of a constant lean after one step: the slow estimate of the DCM bias absorbs the rest.
const double kDcmBiasShare = std::pow(1.0 - 1.0 / 150.0, 26);

TEST(WalkerCapture, MovesTheFootholdForwardTowardsALean) {
  for (const double lean_rad : {0.1, -0.1}) {
    const double sign = lean_rad > 0 ? 1.0 : -1.0;
    const test::Point moved = shift(capturing(500, 500), Side::kLeft, leaning(0, lean_rad));
    EXPECT_NEAR(moved.x, sign * 0.5 * (kDcmBiasShare * kComHeight_m * 0.1 - 0.005), 0.1e-3);
    EXPECT_NEAR(moved.y, 0.0, 0.1e-3);
  }
}

TEST(WalkerCapture, StepsNoFurtherForwardOrBackwardThanAllowed) {
  WalkParameters parameters = capturing(500, 0);
  parameters.step.max_forward = 100;  // 10 mm, half of what the lean asks for
  for (const double lean_rad : {0.3, -0.3}) {
    WalkingRobot robot(parameters);
    for (int step = 0; step < 4; ++step) ASSERT_TRUE(robot.advance_until_landing());
    ASSERT_TRUE(robot.advance_until_landing({}, leaning(0, lean_rad)));
    const double max_m = to_double(Gait(parameters).max_forward);
    EXPECT_NEAR(robot.landings.back().p.x, lean_rad > 0 ? max_m : -max_m, 0.1e-3);
  }
}

TEST(WalkerCapture, MovesTheFootholdLaterallyTowardsALean) {
  // Positive roll about the forward axis x: the robot leans to the right.
  const double shift_m = 0.5 * (kDcmBiasShare * kComHeight_m * 0.1 - 0.005);
  EXPECT_NEAR(shift(capturing(500, 500), Side::kRight, leaning(0.1, 0)).y, -shift_m, 0.1e-3);
  EXPECT_NEAR(shift(capturing(500, 500), Side::kLeft, leaning(-0.1, 0)).y, shift_m, 0.1e-3);
}

TEST(WalkerCapture, WeightsARateByThePendulumsTimeConstant) {
  const double shift_m = 0.5 * (kDcmBiasShare * kComHeight_m * kTimeConstant_s * 0.5 - 0.005);
  EXPECT_NEAR(shift(capturing(500, 0), Side::kLeft, turning(0.5, 0)).x, shift_m, 0.1e-3);
}

TEST(WalkerCapture, DoesNothingWithinTheDeadBandOrWithoutGain) {
  const double band_rad = 0.005 / kComHeight_m;
  const Observation small = leaning(0.9 * band_rad, -0.9 * band_rad);
  const Observation large = leaning(0.2, 0.2);
  for (const auto& [parameters, seen] :
       {std::pair{capturing(1'000, 1'000), small}, std::pair{capturing(0, 0), large}}) {
    WalkingRobot leans(parameters);
    WalkingRobot walks(parameters);
    for (int tick = 0; tick < 300; ++tick) {
      leans.advance({100, 0, 0}, seen);
      walks.advance({100, 0, 0});
      ASSERT_EQ(leans.targets(), walks.targets()) << tick;
    }
  }
}

TEST(WalkerCapture, IgnoresAConstantLean) {
  WalkingRobot robot(capturing(500, 500));
  for (int tick = 0; tick < 1'200; ++tick) robot.advance({}, leaning(0.05, 0.05));
  const test::Point last = robot.landings.back().p;
  EXPECT_NEAR(last.x, 0.0, 0.1e-3);
  EXPECT_NEAR(std::abs(last.y), 0.066, 0.1e-3);
}

TEST(WalkerCapture, ClampsALeanThatNoStepCatches) {
  WalkParameters parameters = capturing(100, 0);
  const double most_m = 0.1 * (kDcmBiasShare * kComHeight_m * 30.0 * M_PI / 180.0 - 0.005);
  EXPECT_NEAR(shift(parameters, Side::kLeft, leaning(0, 1.5)).x, most_m, 0.1e-3);
}

TEST(WalkerCapture, SmoothsTheLean) {
  WalkParameters parameters = capturing(500, 0);
  parameters.reaction.dead_band = 0;
  parameters.reaction.smoothing = 900;
  // Smoothing passes a tenth of each cycle's value, and the bias estimate leaves a_1 = 149 / 150 of it in the
  // first cycle.
  const double fading = 1.0 - 1.0 / 150.0;
  const double share = 0.1 * fading * (kDcmBiasShare - std::pow(0.9, 26)) / (fading - 0.9);
  const test::Point moved = shift(parameters, Side::kLeft, leaning(0, 0.1));
  EXPECT_NEAR(moved.x, share * 0.5 * kComHeight_m * 0.1, 0.1e-3);
}

// Ticks between two landings, when the swing foot is loaded with `load_N` from the given tick after the
// first.
int step_ticks(std::int16_t threshold_cN, double load_N, int from_tick) {
  WalkParameters parameters = rigid();
  parameters.reaction.touchdown_load_cN = threshold_cN;
  WalkingRobot robot(parameters);
  while (robot.landings.size() < 4) robot.advance();
  const int begin = robot.landings.back().tick;
  const std::size_t swings = robot.landings.back().side == Side::kLeft ? kRight : kLeft;
  const auto stands_before = other(robot.landings.back().side);
  // The step ends when the other foot lifts off.
  while (robot.tick < begin + 60) {
    Observation seen;
    if (robot.tick - begin >= from_tick) seen.loads[swings] = from_double<Force>(load_N);
    robot.advance({}, seen);
    if (const auto now = robot.swing_side(); now && *now != stands_before) break;
  }
  return robot.tick - begin;
}

TEST(WalkerTouchdown, EndsAStepEarly) {
  const int in_time = step_ticks(200, 0.0, 0);
  EXPECT_EQ(in_time, 26 + 3 + 1);  // one step and the double support of the next
  EXPECT_EQ(step_ticks(200, 3.0, 20), in_time - 26 + 21);
  EXPECT_EQ(step_ticks(200, 1.9, 20), in_time);
  EXPECT_EQ(step_ticks(0, 3.0, 20), in_time);  // off
}

// 0.6 of the 23 cycles of swing, after 3 cycles of double support.
TEST(WalkerTouchdown, IsIgnoredEarlyInTheSwing) {
  EXPECT_EQ(step_ticks(200, 3.0, 0), step_ticks(200, 0.0, 0) - 26 + 17);
}

// The mass has then moved less than planned: the next step lands further out, and the following ones are as
// before.
TEST(WalkerTouchdown, IsCompensatedByTheNextStep) {
  WalkParameters parameters = rigid();
  parameters.reaction.touchdown_load_cN = 200;
  WalkingRobot robot(parameters);
  while (robot.landings.size() < 4) robot.advance();
  const std::size_t swings = robot.landings.back().side == Side::kLeft ? kRight : kLeft;
  for (int tick = 0; tick < 24; ++tick) robot.advance();
  Observation seen;
  seen.loads[swings] = from_double<Force>(3.0);
  robot.advance({}, seen);
  for (int step = 0; step < 6; ++step) ASSERT_TRUE(robot.advance_until_landing());
  EXPECT_GT(std::abs(robot.landings[5].p.y), 0.08);
  for (std::size_t i = 6; i < robot.landings.size(); ++i) {
    EXPECT_EQ(robot.landings[i].tick - robot.landings[i - 1].tick, 26);
    EXPECT_NEAR(std::abs(robot.landings[i].p.y), 0.066, 0.1e-3);
  }
}

// Returns the heading error at the end of a walk that begins with a disturbance of `turned_rad` in yaw. The
// simulated gyro measures the disturbance and the rotation of the trunk over the support foot.
double heading_left_rad(std::int16_t heading_hold, double turned_rad, const Velocity& command = {}) {
  WalkParameters parameters = rigid();
  parameters.reaction.heading_hold = heading_hold;
  WalkingRobot robot(parameters);
  while (robot.landings.size() < 2) robot.advance();
  constexpr int kShoveTicks = 10;
  constexpr double kTick_s = 0.01;
  double heading_rad = 0.0;
  double rate_rad_per_s = 0.0;
  const auto trunk_yaw_rad = [&](Side from) {
    return test::yaw_rad(robot.posed().trunk_axis({1, 0, 0}, from));
  };
  for (int tick = 0; tick < 1'500; ++tick) {
    const double shove_rad = tick < kShoveTicks ? turned_rad / kShoveTicks : 0.0;
    // A foot that still supports after this tick did not move during it.
    const std::array before{trunk_yaw_rad(Side::kLeft), trunk_yaw_rad(Side::kRight)};
    const auto swung = robot.swing_side();
    robot.advance(command, turning(0, rate_rad_per_s + shove_rad / kTick_s));
    const auto swings = robot.swing_side();
    const Side stands = swings ? other(*swings) : swung ? other(*swung) : Side::kLeft;
    const double turn_rad = trunk_yaw_rad(stands) - before[static_cast<std::size_t>(stands)];
    rate_rad_per_s = turn_rad / kTick_s;
    heading_rad += turn_rad + shove_rad;
  }
  return heading_rad - 1e-3 * command.turn_mrad_per_s * 1'500 * kTick_s;
}

TEST(WalkerHeading, CorrectsADisturbedHeading) {
  EXPECT_NEAR(heading_left_rad(300, 0.3), 0.0, 0.02);
  EXPECT_NEAR(heading_left_rad(300, -0.3), 0.0, 0.02);
}

TEST(WalkerHeading, StaysTurnedWithoutHeadingControl) { EXPECT_NEAR(heading_left_rad(0, 0.3), 0.3, 1e-3); }

// The error is reduced by the lag during a turn.
TEST(WalkerHeading, AlsoHoldsACurve) { EXPECT_NEAR(heading_left_rad(300, 0.3, {0, 0, 300}), 0.0, 0.15); }

}  // namespace
}  // namespace koboshi::walk
