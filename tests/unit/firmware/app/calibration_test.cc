#include "firmware/app/calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"
#include "tests/unit/firmware/motion/motion_builder.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using canopen::AbortCode;
using test::ControllerBench;
using test::degrees;
using test::kCountsPerRadPerS;
using test::kKnee;
using test::SdoPc;

constexpr std::int16_t kFiveDegrees = 910;  // in 2^-16 turns

constexpr canopen::ObjectAddress trim_of(std::size_t joint) {
  return {kTrimObject, static_cast<std::uint8_t>(joint + 1)};
}
canopen::ObjectAddress mounting(std::uint8_t angle) {  // 0: roll
  return {kMountingObject, static_cast<std::uint8_t>(angle + 1)};
}

class ControllerCalibration : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until(State::kLimp)); }
  double angle_rad(std::int16_t value) const { return value / 65536.0 * 2 * M_PI; }

  ControllerBench bench;
  SdoPc pc{bench};
};

TEST_F(ControllerCalibration, TrimIsAddedToTargets) {
  ASSERT_EQ(pc.write(trim_of(kKnee), -kFiveDegrees, 2), AbortCode::kNone);
  const robot::Drive with_trim = bench.model().joints[kKnee].drive;
  ASSERT_TRUE(bench.run_until_standing());
  bench.run_ms(20);
  const std::int32_t trimmed = bench.values().drives.target_position[kKnee];
  EXPECT_NEAR(fixed::to_double(bench.target(kKnee)), test::stored_deg(40) * test::kRadPerDegree, 1e-5);
  ASSERT_EQ(pc.write(trim_of(kKnee), 0, 2), AbortCode::kNone);
  bench.run_ms(20);
  const std::int32_t untrimmed = bench.values().drives.target_position[kKnee];
  const double counts = std::ldexp(kFiveDegrees / 65536.0, with_trim.position_bits);
  EXPECT_NEAR(trimmed - untrimmed, -with_trim.sign * counts, 1.0);
}

TEST_F(ControllerCalibration, TrimIsSubtractedFromPositions) {
  bench.run_ms(20);
  const double before_rad = fixed::to_double(bench.target(kKnee));  // limp: the target follows the joint
  const std::int32_t position = bench.values().drives.target_position[kKnee];
  ASSERT_EQ(pc.write(trim_of(kKnee), -kFiveDegrees, 2), AbortCode::kNone);
  bench.run_ms(20);
  EXPECT_EQ(bench.values().drives.target_position[kKnee], position);
  EXPECT_NEAR(fixed::to_double(bench.target(kKnee)) - before_rad, angle_rad(kFiveDegrees), 1e-5);
}

TEST_F(ControllerCalibration, TrimIsLimitedToTenDegrees) {
  EXPECT_EQ(pc.write(trim_of(kKnee), 1'820, 2), AbortCode::kNone);
  EXPECT_EQ(pc.write(trim_of(kKnee), 1'821, 2), AbortCode::kValueTooHigh);
  EXPECT_EQ(pc.write(trim_of(kKnee), -1'821, 2), AbortCode::kValueTooLow);
  EXPECT_EQ(bench.values().calibration.trims[kKnee], 1'820);
}

TEST_F(ControllerCalibration, AttitudeIsRightOnceTheMountingIsKnown) {
  // The IMU is mounted with 20 degrees of roll, then -10 of pitch. This is its reading of gravity at rest.
  const double roll_rad = 20 * test::kRadPerDegree;
  const double pitch_rad = -10 * test::kRadPerDegree;
  const double one_g = bench.imu_sample.accelerometer_raw[2];
  // R_BI = Ry Rx, so g_I = Rx^T Ry^T (0 0 1)^T.
  const double x = -std::sin(pitch_rad);
  const double z = std::cos(pitch_rad);
  bench.imu_sample.accelerometer_raw = {static_cast<std::int16_t>(one_g * x),
                                        static_cast<std::int16_t>(one_g * std::sin(roll_rad) * z),
                                        static_cast<std::int16_t>(one_g * std::cos(roll_rad) * z)};
  bench.run_ms(3'000);
  EXPECT_NEAR(bench.values().attitude.roll, 3'641, 60);  // attitude of an upright robot without the mounting
                                                         // correction: 20 degrees
  ASSERT_EQ(pc.write(mounting(0), 3'641, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(mounting(1), -1'820, 2), AbortCode::kNone);
  bench.run_ms(3'000);
  EXPECT_NEAR(bench.values().attitude.roll, 0, 10);
  EXPECT_NEAR(bench.values().attitude.pitch, 0, 10);
  EXPECT_NEAR(bench.values().attitude.acceleration[2], 9.80665 * 256, 5);
}

TEST_F(ControllerCalibration, RotatesRatesByTheMounting) {
  ASSERT_EQ(pc.write(mounting(2), 5'461, 2), AbortCode::kNone);  // 30 degrees to the left
  bench.imu_sample.gyro_raw[0] = static_cast<std::int16_t>(kCountsPerRadPerS);
  bench.run_ms(300);
  const double unit = 4096 / (2 * M_PI);
  EXPECT_NEAR(bench.values().attitude.rate[0], std::cos(M_PI / 6) * unit, 5);
  EXPECT_NEAR(bench.values().attitude.rate[1], std::sin(M_PI / 6) * unit, 5);
}

TEST_F(ControllerCalibration, MountingDoesNotChangeUnderARobotThatStands) {
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(pc.write(mounting(0), 100, 2), AbortCode::kDeviceState);
  EXPECT_EQ(pc.write({kGyroBiasObject, 1}, 100, 4), AbortCode::kDeviceState);
  EXPECT_EQ(pc.write(trim_of(kKnee), 100, 2), AbortCode::kNone);  // accepted: trims are set by observing the
                                                                  // robot
}

TEST_F(ControllerCalibration, BiasIsMeasuredOnCommandAndKept) {
  bench.imu_sample.gyro_raw[2] = 100;
  bench.run_ms(300);
  bench.command(Command::kCalibrate);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  EXPECT_EQ(bench.values().calibration.gyro_bias[2], 0);
  bench.run_ms(1'100);
  const double expected = 100 / kCountsPerRadPerS / (2 * M_PI) * (1 << 24);
  EXPECT_NEAR(bench.values().calibration.gyro_bias[2], expected, expected * 0.01);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  const std::int32_t bias = bench.values().calibration.gyro_bias[2];
  ASSERT_EQ(pc.save(), AbortCode::kNone);

  // In effect immediately after power-on.
  bench.restart();
  bench.run_ms(200);
  EXPECT_EQ(bench.values().calibration.gyro_bias[2], bias);
  EXPECT_EQ(bench.values().diagnosis.gyro_calibrations, 0);
  EXPECT_NEAR(bench.values().attitude.rate[2], 0, 1);
}

TEST_F(ControllerCalibration, IsRefusedToARobotThatIsMoved) {
  bench.command(Command::kCalibrate);
  bench.run_ms(300);
  bench.imu_sample.gyro_raw[2] = 500;
  bench.run_ms(1'000);
  EXPECT_EQ(bench.now().refusal, Reason::kNotAtRest);
  EXPECT_EQ(bench.values().calibration.gyro_bias[2], 0);
  bench.run_ms(2'000);  // no later second changes the result
  EXPECT_EQ(bench.values().calibration.gyro_bias[2], 0);
}

TEST_F(ControllerCalibration, IsRefusedToARobotThatStands) {
  bench.command(Command::kCalibrate);
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(bench.now().refusal, Reason::kNotAtRest);  // the enable command interrupted the second of rest
  bench.command(Command::kCalibrate);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
}

TEST_F(ControllerCalibration, SurvivesAPowerCycle) {
  ASSERT_EQ(pc.write(trim_of(kKnee), kFiveDegrees, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(mounting(1), -1'820, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  const robot::Drive drive = bench.model().joints[kKnee].drive;
  const robot::Rotation R_BI = bench.model().R_BI;
  bench.restart();
  ASSERT_TRUE(bench.run_until(State::kLimp));
  EXPECT_EQ(bench.model().joints[kKnee].drive.zero, drive.zero);
  EXPECT_EQ(bench.model().R_BI, R_BI);
  // And only once, however often it is loaded.
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.model().joints[kKnee].drive.zero, drive.zero);
  EXPECT_EQ(bench.model().R_BI, R_BI);
}

}  // namespace
}  // namespace koboshi::app
