#include "firmware/estimation/inertial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/fixed/host/filter_design.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::to_double;

class InertialSensorTest : public testing::Test {
 protected:
  // Converts to counts in the test robot's scales: 17.45 rad/s and 39.2 m/s^2 at 2^15.
  static std::int16_t gyro_counts(double rate_rad_per_s) {
    return static_cast<std::int16_t>(std::lround(rate_rad_per_s / 17.45 * 32768));
  }
  static std::int16_t accelerometer_counts(double acceleration_m_per_s2) {
    return static_cast<std::int16_t>(std::lround(acceleration_m_per_s2 / 39.2 * 32768));
  }
  void settle(const hal::ImuSample& sample, int samples = 200) {
    for (int i = 0; i < samples; ++i) sensor.add(sample, now_us += 1'000);
  }

  robot::RobotModel model = test::make_test_robot();
  InertialSensor sensor{model};
  std::uint64_t now_us = 0;
};

TEST(InertialLowPass, IsTwentyHertzAtFiveHundredMeansASecond) {
  const fixed::BiquadCoefficients designed = fixed::design_low_pass(20, 500);
  EXPECT_EQ(kInertialLowPass.b0, designed.b0);
  EXPECT_EQ(kInertialLowPass.b1, designed.b1);
  EXPECT_EQ(kInertialLowPass.b2, designed.b2);
  EXPECT_EQ(kInertialLowPass.a1, designed.a1);
  EXPECT_EQ(kInertialLowPass.a2, designed.a2);
}

TEST_F(InertialSensorTest, ScalesByTheModel) {
  settle({.gyro_raw = {gyro_counts(1.0), gyro_counts(-2.0), gyro_counts(3.0)},
          .accelerometer_raw = {accelerometer_counts(1.0), accelerometer_counts(-2.0),
                                accelerometer_counts(9.80665)}});
  EXPECT_NEAR(to_double(sensor.rates().x), 1.0, 3e-4);  // half a count
  EXPECT_NEAR(to_double(sensor.rates().y), -2.0, 3e-4);
  EXPECT_NEAR(to_double(sensor.rates().z), 3.0, 3e-4);
  EXPECT_NEAR(to_double(sensor.accelerations().x), 1.0, 7e-4);
  EXPECT_NEAR(to_double(sensor.accelerations().y), -2.0, 7e-4);
  EXPECT_NEAR(to_double(sensor.accelerations().z), 9.80665, 7e-4);
}

TEST_F(InertialSensorTest, RotatesIntoTheAxesOfTheTrunk) {
  // An IMU whose x points along the trunk's y, and whose y points along the trunk's -x.
  const auto one = fixed::kOne;
  const fixed::Ratio zero;
  model.R_BI.rows = {{{zero, -one, zero}, {one, zero, zero}, {zero, zero, one}}};
  settle({.gyro_raw = {gyro_counts(1.0), 0, 0}, .accelerometer_raw = {0, accelerometer_counts(2.0), 0}});
  EXPECT_NEAR(to_double(sensor.rates().y), 1.0, 3e-4);
  EXPECT_NEAR(to_double(sensor.accelerations().x), -2.0, 7e-4);
}

TEST_F(InertialSensorTest, PassesTheFirstSampleAndFiltersTheMeanOfEachTwo) {
  sensor.add({.accelerometer_raw = {0, 0, 8'000}}, 1'000);
  const double first = to_double(sensor.accelerations().z);
  EXPECT_NEAR(first, 8'000 * 39.2 / 32768, 1e-3);
  sensor.add({.accelerometer_raw = {0, 0, 12'000}}, 2'000);
  EXPECT_EQ(to_double(sensor.accelerations().z), first);
  sensor.add({.accelerometer_raw = {0, 0, 20'000}}, 3'000);
  EXPECT_NEAR(to_double(sensor.accelerations().z) / first, 1.0 + to_double(kInertialLowPass.b0), 1e-4);
}

TEST_F(InertialSensorTest, IntegratesItsSamplesMinusTheBias) {
  const auto turn = [&](double bias_rad_per_s) {
    const auto bias = fixed::from_double<fixed::AngularRate>(bias_rad_per_s);
    return sensor.take_turn({{}, bias, {}});
  };
  for (int i = 0; i < 10; ++i) {
    sensor.add({.gyro_raw = {0, gyro_counts(i % 2 == 0 ? 2.0 : 1.0), gyro_counts(-3.0)}}, now_us += 1'000);
  }
  const auto first = turn(0.5);
  EXPECT_NEAR(to_double(first.x), 0.0, 1e-9);
  EXPECT_NEAR(to_double(first.y), 0.010, 3e-6);  // resolution of the counts
  EXPECT_NEAR(to_double(first.z), -0.030, 3e-6);
  EXPECT_EQ(turn(0.5).y, fixed::Ratio());  // no rotation without a sample
}

TEST_F(InertialSensorTest, ReportsTheTimeOfTheLastSample) {
  EXPECT_EQ(sensor.last_us(), std::nullopt);
  sensor.add({}, 100'000);
  EXPECT_EQ(sensor.last_us(), 100'000u);
}

}  // namespace
}  // namespace koboshi::estimation
