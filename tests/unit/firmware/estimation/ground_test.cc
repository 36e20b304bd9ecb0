#include "firmware/estimation/ground.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::from_double;
using fixed::to_double;

constexpr double kComAbove_m = 0.16;

// A robot on a floor that rises by these tangents ahead and to the left, as it stands, with soles flat on the
// floor, a bias of the attitude and an offset of the centre of mass.
struct Stand {
  double rise_x = 0.0;
  double rise_y = 0.0;
  double bias_x = 0.0;
  double bias_y = 0.0;
  double offset_x_m = 0.0;
  double offset_y_m = 0.0;

  const Ground& update(GroundEstimator& estimator) const {
    Posture posture;
    posture.X_BSole[hal::Side::kRight].p = test::position(0.0, -0.08, 0.0);
    posture.p_BCom = test::position(0.01, -0.03, kComAbove_m);
    // The centre of pressure is below the true centre of mass.
    const Pressure zmp{.frame = hal::Side::kRight,
                       .valid = true,
                       .x = from_double<fixed::Length>(0.01 + offset_x_m - kComAbove_m * rise_x),
                       .y = from_double<fixed::Length>(0.05 + offset_y_m - kComAbove_m * rise_y)};
    const double x = rise_x + bias_x;
    const double y = rise_y + bias_y;
    const double length = std::sqrt(1 + x * x + y * y);
    const robot::Direction up{from_double<fixed::Ratio>(x / length), from_double<fixed::Ratio>(y / length),
                              from_double<fixed::Ratio>(1 / length)};
    return estimator.update(posture, up, zmp);
  }
};

TEST(GroundEstimator, FindsASlopeAtOnce) {
  GroundEstimator estimator;
  EXPECT_FALSE(estimator.ground().valid);
  const Ground ground = Stand{.rise_x = 0.05, .rise_y = -0.03}.update(estimator);
  EXPECT_TRUE(ground.valid);
  EXPECT_NEAR(to_double(ground.slope_x), 0.05, 1e-6);
  EXPECT_NEAR(to_double(ground.slope_y), -0.03, 1e-6);
  EXPECT_NEAR(to_double(ground.zero_x), 0.0, 1e-6);
  EXPECT_NEAR(to_double(ground.zero_y), 0.0, 1e-6);
}

// What it cannot tell apart it weights: 0.73 by the pressure, 0.27 by the attitude.
TEST(GroundEstimator, WeightsBiasAndOffset) {
  GroundEstimator estimator;
  const Ground biased = Stand{.rise_x = 0.02, .bias_x = 0.04, .bias_y = -0.02}.update(estimator);
  EXPECT_NEAR(to_double(biased.slope_x), 0.02 + 0.27 * 0.04, 1e-6);
  EXPECT_NEAR(to_double(biased.slope_y), -0.27 * 0.02, 1e-6);
  EXPECT_NEAR(to_double(biased.zero_x), 0.73 * 0.04, 1e-6);
  EXPECT_NEAR(to_double(biased.zero_y), -0.73 * 0.02, 1e-6);
  GroundEstimator other;
  const Ground offset = Stand{.offset_x_m = 0.005, .offset_y_m = -0.002}.update(other);
  EXPECT_NEAR(to_double(offset.slope_x), -0.73 * 0.005 / kComAbove_m, 1e-6);
  EXPECT_NEAR(to_double(offset.slope_y), 0.73 * 0.002 / kComAbove_m, 1e-6);
}

TEST(GroundEstimator, SmoothsWhatFollows) {
  GroundEstimator estimator;
  Stand{}.update(estimator);
  for (int cycle = 0; cycle < 30; ++cycle) Stand{.rise_x = 0.1}.update(estimator);
  EXPECT_NEAR(to_double(estimator.ground().slope_x), 0.1 * (1 - std::exp(-1.0)), 1e-3);
}

TEST(GroundEstimator, KeepsItsEstimateWithoutAPressure) {
  GroundEstimator estimator;
  Stand{.rise_x = 0.05}.update(estimator);
  const Ground& ground = estimator.update({}, robot::kAxisZ, {});
  EXPECT_TRUE(ground.valid);
  EXPECT_NEAR(to_double(ground.slope_x), 0.05, 1e-6);
}

}  // namespace
}  // namespace koboshi::estimation
