#include "firmware/estimation/gyro_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::AngularRate;
using fixed::from_double;
using fixed::to_double;

using test::kRadPerDegree;

GyroBias::Rates deg_per_s(double x_deg_per_s, double y_deg_per_s, double z_deg_per_s) {
  const auto rate = [](double value) { return from_double<AngularRate>(value * kRadPerDegree); };
  return {rate(x_deg_per_s), rate(y_deg_per_s), rate(z_deg_per_s)};
}

// Returns true if one of the observations completed a second of rest.
bool observe(GyroBias& bias, const GyroBias::Rates& sample, int times) {
  bool complete = false;
  for (int i = 0; i < times; ++i) complete = bias.observe(sample) || complete;
  return complete;
}

TEST(GyroBias, IsZeroBeforeTheFirstSecondOfRest) {
  GyroBias bias;
  EXPECT_FALSE(observe(bias, deg_per_s(5, 5, 5), GyroBias::kSamples - 1));
  EXPECT_EQ(bias.bias(), GyroBias::Rates{});
}

TEST(GyroBias, IsTheMeanOfASecondOfRest) {
  GyroBias bias;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> noise(-100, 100);  // 0.05 deg/s
  const double unit = 0.0005;
  double sum = 0.0;
  bool complete = false;
  for (int i = 0; i < GyroBias::kSamples; ++i) {
    const double y = -20.0 + unit * noise(random);
    sum += y;
    complete = bias.observe(deg_per_s(20, y, 0));
  }
  EXPECT_TRUE(complete);
  EXPECT_EQ(bias.bias().x, deg_per_s(20, 0, 0).x);
  EXPECT_NEAR(to_double(bias.bias().y) / kRadPerDegree, sum / GyroBias::kSamples, 3e-5);
  EXPECT_EQ(bias.bias().z, AngularRate());
}

TEST(GyroBias, DiscardsASecondInWhichTheRobotMoved) {
  GyroBias bias;
  ASSERT_TRUE(observe(bias, deg_per_s(1, 2, 3), GyroBias::kSamples));
  // Swaying at 1 Hz with an amplitude of 0.7 deg/s, above the limit.
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(bias.observe(deg_per_s(0, 0, 0.7 * std::sin(2.0 * std::numbers::pi * 0.01 * i)))) << i;
  }
  EXPECT_EQ(bias.bias(), deg_per_s(1, 2, 3));
}

TEST(GyroBias, RestartsTheSecondAtEachMovement) {
  GyroBias bias;
  observe(bias, deg_per_s(0, 0, 0), 50);
  EXPECT_FALSE(observe(bias, deg_per_s(0, 9, 0), GyroBias::kSamples));  // the first sample still saw the
                                                                        // movement
  EXPECT_TRUE(observe(bias, deg_per_s(0, 9, 0), 1));
  EXPECT_EQ(bias.bias(), deg_per_s(0, 9, 0));
}

TEST(GyroBias, DiscardsASecondInterruptedByTorque) {
  GyroBias bias;
  observe(bias, deg_per_s(4, 0, 0), 60);
  bias.interrupt();
  EXPECT_FALSE(observe(bias, deg_per_s(4, 0, 0), 60));
  EXPECT_EQ(bias.bias(), GyroBias::Rates{});
}

}  // namespace
}  // namespace koboshi::estimation
