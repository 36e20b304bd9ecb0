#include "sim_board/sensor/sensitivity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim_board/sensor/channel.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(AxisGains, AreThoseOfAPerfectTriadWithoutErrors) {
  EXPECT_EQ(AxisGains(0.0, 0.0, 1, "gyro").value(), Matrix3d::Identity());
}

TEST(AxisGains, AreDrawnUniformlyWithinTheirBounds) {
  constexpr double kScale = 0.03;
  constexpr double kCross = 0.02;
  constexpr int kSeeds = 2000;
  Matrix3d mean = Matrix3d::Zero();
  Matrix3d square = Matrix3d::Zero();
  Matrix3d largest = Matrix3d::Zero();
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Matrix3d error = AxisGains(kScale, kCross, seed, "gyro").value() - Matrix3d::Identity();
    mean += error / kSeeds;
    square += error.cwiseAbs2() / kSeeds;
    largest = largest.cwiseMax(error.cwiseAbs());
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double bound = i == j ? kScale : kCross;
      EXPECT_LE(largest(i, j), bound * (1.0 + 1e-12));
      EXPECT_GT(largest(i, j), 0.99 * bound);
      // Four standard deviations of the mean and of the mean square of a uniform number.
      EXPECT_NEAR(mean(i, j), 0.0, 4.0 * bound / std::sqrt(3.0 * kSeeds));
      EXPECT_NEAR(square(i, j) / (bound * bound), 1.0 / 3.0, 4.0 * std::sqrt(4.0 / 45.0 / kSeeds));
    }
  }
}

TEST(AxisGains, DifferByElementAndName) {
  const Matrix3d gyro = AxisGains(0.1, 0.1, 1, "gyro").value();
  const Matrix3d other = AxisGains(0.1, 0.1, 1, "accelerometer").value();
  EXPECT_NE(gyro(0, 0), gyro(1, 1));
  EXPECT_NE(gyro(0, 1), gyro(1, 0));
  EXPECT_NE(gyro(0, 0) - 1.0, gyro(0, 1));
  EXPECT_NE(gyro(0, 1), other(0, 1));
  // The one does not change what the other draws.
  EXPECT_EQ(AxisGains(0.0, 0.1, 1, "gyro").value()(2, 1), gyro(2, 1));
}

TEST(CrossSensitivity, IsDrawnWithinItsBound) {
  Matrix3d largest = Matrix3d::Zero();
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    largest = largest.cwiseMax(CrossSensitivity(0.5, seed, "gyro").value().cwiseAbs());
  }
  EXPECT_LE(largest.maxCoeff(), 0.5);
  EXPECT_GT(largest.minCoeff(), 0.49);
  EXPECT_EQ(CrossSensitivity(0.0, 1, "gyro").value(), Matrix3d::Zero());
}

Vector3d shown(Channel& channel, const Vector3d& value, double resolution) {
  channel.filter().settle(value);
  const std::array<std::int16_t, 3> counts = channel.sample();
  return resolution * Vector3d(counts[0], counts[1], counts[2]);
}

TEST(Channel, AppliesScaleAndCrossAxisInEachDirection) {
  ChannelDescription description;
  description.scale_error = 0.03;
  description.cross_axis = 0.02;
  description.range = 3.0;
  description.resolution = 1e-4;
  Channel channel(description, "gyro", {.seed = 3});
  const Matrix3d gains = AxisGains(0.03, 0.02, 3, "gyro").value();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d value = 2.5 * Vector3d::Unit(axis);
    EXPECT_LT((shown(channel, value, 1e-4) - gains * value).cwiseAbs().maxCoeff(), 0.51e-4);
    EXPECT_LT((shown(channel, -value, 1e-4) + gains * value).cwiseAbs().maxCoeff(), 0.51e-4);
  }
}

// The scenario's factor.
TEST(Channel, ScalesEachOfItsErrors) {
  ChannelDescription description;
  description.scale_error = 0.03;
  description.cross_axis = 0.02;
  description.bias_instability = 0.1;
  description.random_walk = 0.1;
  description.range = 3.0;
  description.resolution = 1e-4;
  Channel perfect(description, "gyro", {.seed = 3, .scale = 0.0});
  for (int i = 0; i < 100; ++i) ASSERT_EQ(shown(perfect, {1.0, -2.0, 0.5}, 1e-4), Vector3d(1.0, -2.0, 0.5));
  description.bias_instability = 0.0;
  description.random_walk = 0.0;
  Channel twice(description, "gyro", {.seed = 3, .scale = 2.0});
  EXPECT_NEAR(shown(twice, Vector3d::UnitX(), 1e-4).y(), AxisGains(0.06, 0.04, 3, "gyro").value()(1, 0),
              0.51e-4);
}

AnkleSensorDescription ankle(double crosstalk) {
  AnkleSensorDescription sensor;
  sensor.name = "left_ankle";
  sensor.force.range = 100.0;
  sensor.torque.range = 4.0;
  sensor.crosstalk = crosstalk;
  return sensor;
}

TEST(AnkleCrosstalk, IsBoundedByItsFractionOfTheRanges) {
  double largest_N = 0.0;
  double largest_Nm = 0.0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const AnkleCrosstalk crosstalk(ankle(0.01), {.seed = seed});
    const Wrench by_force = crosstalk.apply({{0.0, 0.0, 100.0}, Vector3d::Zero()});
    const Wrench by_torque = crosstalk.apply({Vector3d::Zero(), {4.0, 0.0, 0.0}});
    EXPECT_EQ(by_force.force_N, Vector3d(0.0, 0.0, 100.0));
    EXPECT_EQ(by_torque.torque_Nm, Vector3d(4.0, 0.0, 0.0));
    largest_Nm = std::max(largest_Nm, by_force.torque_Nm.cwiseAbs().maxCoeff());
    largest_N = std::max(largest_N, by_torque.force_N.cwiseAbs().maxCoeff());
  }
  EXPECT_LE(largest_Nm, 0.04);
  EXPECT_GT(largest_Nm, 0.0396);
  EXPECT_LE(largest_N, 1.0);
  EXPECT_GT(largest_N, 0.99);
}

TEST(AnkleCrosstalk, IsLinearAndDiffersByElement) {
  const AnkleCrosstalk crosstalk(ankle(0.02), {.seed = 4});
  const Wrench x = crosstalk.apply({Vector3d::UnitX(), Vector3d::Zero()});
  const Wrench y = crosstalk.apply({Vector3d::UnitY(), Vector3d::UnitZ()});
  const Wrench both = crosstalk.apply({{3.0, -2.0, 0.0}, {0.0, 0.0, -2.0}});
  EXPECT_LT((both.force_N - 3.0 * x.force_N + 2.0 * y.force_N).norm(), 1e-12);
  EXPECT_LT((both.torque_Nm - 3.0 * x.torque_Nm + 2.0 * y.torque_Nm).norm(), 1e-12);
  EXPECT_NE(x.torque_Nm.x(), x.torque_Nm.y());
  EXPECT_NE(x.torque_Nm.x(), y.torque_Nm.x());
}

TEST(AnkleCrosstalk, IsZeroWhenAbsentOrScaledToZero) {
  const Wrench wrench{{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  for (const AnkleCrosstalk& crosstalk :
       {AnkleCrosstalk(ankle(0.0), {}), AnkleCrosstalk(ankle(0.01), {.scale = 0.0})}) {
    EXPECT_EQ(crosstalk.apply(wrench).force_N, wrench.force_N);
    EXPECT_EQ(crosstalk.apply(wrench).torque_Nm, wrench.torque_Nm);
  }
}

}  // namespace
}  // namespace koboshi::sim_board
