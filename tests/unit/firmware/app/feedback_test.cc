#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"
#include "tests/unit/firmware/motion/motion_builder.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;
using test::kKnee;

constexpr std::size_t kAnklePitch = 4;
constexpr std::int16_t kOneRadPerS = 1878;  // in counts of the test robot's gyro: 17.45 rad/s at 2^15

// Gain objects 0x2101 to 0x2105.
enum Gains : std::uint8_t { kMotionRate = 0x01, kStandingRate, kStandingLean, kWalkingRate, kWalkingLean };

// Writes two bytes to a gain object by expedited download.
void set_gain(ControllerBench& bench, Gains gains, std::uint8_t subindex, std::uint8_t low,
              std::uint8_t high = 0) {
  bench.board.can.deliver({.identifier = 0x601, .size = 8, .data = {0x2B, gains, 0x21, subindex, low, high}});
  bench.run_ms(1);
}

class ControllerFeedback : public testing::Test {
 protected:
  // Switches all gains off; each test enables those under test. Fall detection is off because the trunk
  // turns far.
  void SetUp() override {
    bench.board.can.deliver({.identifier = 0x601, .size = 8, .data = {0x2B, 0x40, 0x21, 1, 0, 0}});
    for (const Gains gains : {kStandingRate, kStandingLean, kWalkingRate, kWalkingLean}) {
      for (std::uint8_t joint = 1; joint <= 5; ++joint) set_gain(bench, gains, joint, 0);
    }
  }
  void pitch_forward() {
    bench.imu_sample.gyro_raw[1] = kOneRadPerS;
    bench.run_ms(300);
  }
  double target_rad(std::size_t joint) const { return fixed::to_double(bench.target(joint)); }

  ControllerBench bench;
};

TEST_F(ControllerFeedback, IsOffWithoutGains) {
  ASSERT_TRUE(bench.run_until_standing());
  const auto before = bench.target(kAnklePitch);
  pitch_forward();
  EXPECT_EQ(bench.target(kAnklePitch), before);
}

TEST_F(ControllerFeedback, TurnsTheAnklesOfAStandingRobot) {
  set_gain(bench, kStandingRate, 1, 205);
  EXPECT_EQ(bench.values().feedback.standing.rate.ankle_pitch, 205);
  ASSERT_TRUE(bench.run_until_standing());
  const double before_rad = target_rad(kAnklePitch);
  pitch_forward();
  // Gain of 205 / 4096 s; the drive resolves 6e-6 rad.
  EXPECT_NEAR(target_rad(kAnklePitch) - before_rad, 205.0 / 4096 * kOneRadPerS / 32768.0 * 17.45, 1e-5);
  bench.imu_sample.gyro_raw[1] = 0;
  bench.run_ms(500);
  EXPECT_NEAR(target_rad(kAnklePitch), before_rad, 1e-5);
}

TEST_F(ControllerFeedback, TurnsTheAnklesOfAWalkingRobotBySeparateGains) {
  const auto walks_to_rad = [](Gains gains) {
    ControllerBench bench;
    set_gain(bench, kWalkingRate, 1, 0);
    set_gain(bench, gains, 1, 0, 4);  // a quarter
    EXPECT_TRUE(bench.run_until_ready_to_walk());
    bench.command(Command::kWalk);
    bench.imu_sample.gyro_raw[1] = kOneRadPerS;
    bench.run_ms(200);
    return fixed::to_double(bench.target(kAnklePitch));
  };
  const double without_rad = walks_to_rad(kStandingRate);
  EXPECT_NEAR(walks_to_rad(kWalkingRate) - without_rad, 0.25, 0.03);
}

// The test robot's attitude integrates its gyro: 0.3 s at 1 rad/s.
TEST_F(ControllerFeedback, CountersTheLeanOfAStandingRobot) {
  set_gain(bench, kStandingLean, 1, 0x00, 0x08);  // one half
  set_gain(bench, kWalkingLean, 1, 0x00, 0x10);
  ASSERT_TRUE(bench.run_until_standing());
  const double before_rad = target_rad(kAnklePitch);
  pitch_forward();
  bench.imu_sample.gyro_raw[1] = 0;
  bench.run_ms(20);
  const double lean_rad = bench.values().attitude.pitch * 2 * 3.14159265 / 65536;
  EXPECT_GT(lean_rad, 0.1);
  EXPECT_NEAR(target_rad(kAnklePitch) - before_rad, 0.5 * lean_rad, 1e-3);
}

TEST_F(ControllerFeedback, IgnoresTheLeanDuringAMotion) {
  set_gain(bench, kStandingLean, 1, 0x00, 0x10);
  set_gain(bench, kWalkingLean, 1, 0x00, 0x10);
  ASSERT_TRUE(bench.run_until_standing());
  bench.command(Command::kPlay, 1);
  ASSERT_EQ(bench.now().state, State::kMotion);
  const double before_rad = target_rad(kAnklePitch);
  pitch_forward();
  EXPECT_NEAR(target_rad(kAnklePitch), before_rad, 1e-5);
}

TEST_F(ControllerFeedback, AddsToAMotion) {
  set_gain(bench, kMotionRate, 1, 205);
  ASSERT_TRUE(bench.run_until_standing());
  bench.command(Command::kPlay, 1);
  ASSERT_EQ(bench.now().state, State::kMotion);
  const double before_rad = target_rad(kAnklePitch);
  pitch_forward();
  EXPECT_NEAR(target_rad(kAnklePitch) - before_rad, 0.05, 1e-3);
}

TEST_F(ControllerFeedback, KeepsTargetsWithinTheirLimits) {
  set_gain(bench, kStandingRate, 4, 0x00, 0x10);  // one second
  ASSERT_TRUE(bench.run_until_standing());
  bench.imu_sample.gyro_raw[1] = -32'768;
  bench.run_ms(300);
  EXPECT_GE(bench.target(kKnee), bench.model().joints[kKnee].lower);
  EXPECT_NEAR(target_rad(kKnee), (test::stored_deg(40) - 15) * test::kRadPerDegree, 1e-5);
}

TEST_F(ControllerFeedback, RefusesAGainAboveOneSecond) {
  set_gain(bench, kMotionRate, 2, 0x01, 0x10);
  EXPECT_EQ(bench.values().feedback.motion.ankle_roll, 0);
  const auto answer = bench.last_sent(0x581);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->data[0], 0x80);
}

TEST_F(ControllerFeedback, IsIndependentOfTheGyroBias) {
  bench.imu_sample.gyro_raw = {0, kOneRadPerS / 3, 0};  // 19 deg/s
  set_gain(bench, kStandingRate, 1, 205);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  bench.run_ms(1'100);
  EXPECT_GE(bench.values().diagnosis.gyro_calibrations, 1);
  EXPECT_NEAR(bench.values().diagnosis.gyro_bias[1], 17.45 / 3 * kOneRadPerS / 32768 * 4096 / 6.2832, 1.0);
  EXPECT_EQ(bench.values().attitude.rate[1], 0);
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_NEAR(target_rad(kAnklePitch), 0.0, 1e-5);
  pitch_forward();
  EXPECT_NEAR(target_rad(kAnklePitch), 0.05 * 2 / 3, 1e-3);
}

TEST_F(ControllerFeedback, ReportsAnUnknownBiasWithoutASecondOfRest) {
  for (int i = 0; i < 200; ++i) {
    bench.imu_sample.gyro_raw[2] = i % 20 < 10 ? kOneRadPerS : -kOneRadPerS;
    bench.run_ms(10);
  }
  EXPECT_EQ(bench.values().diagnosis.gyro_calibrations, 0);
  EXPECT_EQ(bench.values().diagnosis.gyro_bias[2], 0);
}

}  // namespace
}  // namespace koboshi::app
