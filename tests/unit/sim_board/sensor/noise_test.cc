#include "sim_board/sensor/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <vector>

namespace koboshi::sim_board {
namespace {

TEST(RandomStream, IsReproducibleForEqualSeedAndName) {
  RandomStream a(7, "imu.gyro");
  RandomStream b(7, "imu.gyro");
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.normal(), b.normal());
}

TEST(RandomStream, DiffersForAnotherSeedOrName) {
  std::set<std::uint64_t> first_draws;
  for (const char* name : {"imu.gyro", "imu.accelerometer", "left.force", ""}) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) first_draws.insert(RandomStream(seed, name).bits());
  }
  EXPECT_EQ(first_draws.size(), 400u);
}

// Numbers of a second implementation, in Python: another algorithm would silently change every recorded run.
TEST(RandomStream, KeepsItsSequence) {
  RandomStream random(1, "imu.gyro.noise");
  EXPECT_EQ(random.bits(), 4037510125343893620u);
  EXPECT_EQ(random.bits(), 4876871273338492604u);
  EXPECT_EQ(random.uniform(), 0.37710262165506581);
  EXPECT_DOUBLE_EQ(random.normal(), -2.4069887019708616);
}

TEST(RandomStream, IsUniform) {
  RandomStream random(3, "uniform");
  constexpr int kDraws = 160'000;
  std::vector<int> bins(16);
  for (int i = 0; i < kDraws; ++i) ++bins.at(static_cast<std::size_t>(random.uniform() * 16.0));
  double chi_squared = 0.0;
  for (const int count : bins) chi_squared += std::pow(count - kDraws / 16, 2) / (kDraws / 16);
  EXPECT_LT(chi_squared, 30.6);  // 15 degrees of freedom, 1 %
  EXPECT_GT(chi_squared, 5.2);   // and 99 %
}

TEST(RandomStream, IsNormal) {
  RandomStream random(5, "normal");
  constexpr int kDraws = 200'000;
  double mean = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    mean += x / kDraws;
    square += x * x / kDraws;
    fourth += x * x * x * x / kDraws;
    if (std::abs(x) > 2.0) ++beyond_two;
  }
  // Four standard deviations of each estimate.
  EXPECT_NEAR(mean, 0.0, 0.009);
  EXPECT_NEAR(square, 1.0, 0.0127);
  EXPECT_NEAR(fourth, 3.0, 0.088);
  EXPECT_NEAR(beyond_two / static_cast<double>(kDraws), 0.0455, 0.0019);
}

TEST(WhiteNoise, HasTheVarianceOfItsDensity) {
  constexpr double kDensity = 0.005;  // deg/s/sqrt(Hz), MPU-6050 class
  WhiteNoise noise(kDensity, 0.001, 1, "gyro");
  EXPECT_DOUBLE_EQ(noise.sigma(), kDensity * std::sqrt(500.0));
  constexpr int kSamples = 50'000;
  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  double cross = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d sample = noise.sample() / noise.sigma();
    square += sample.cwiseAbs2() / kSamples;
    cross += sample.x() * sample.y() / kSamples;
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(square[axis], 1.0, 0.0253) << axis;
  EXPECT_NEAR(cross, 0.0, 0.018);
}

// One-sided power density averaged over 256 segments of 64 samples is density^2 in every bin but the ends'.
TEST(WhiteNoise, IsFlatUpToHalfTheSamplingRate) {
  constexpr double kDensity = 4.0;
  constexpr double kRate_Hz = 1000.0;
  constexpr int kSegment = 64;
  constexpr int kSegments = 256;
  WhiteNoise noise(kDensity, 1.0 / kRate_Hz, 11, "flat");
  std::vector<double> density(kSegment / 2);
  for (int segment = 0; segment < kSegments; ++segment) {
    std::vector<double> samples;
    for (int i = 0; i < kSegment; ++i) samples.push_back(noise.sample().z());
    for (int bin = 1; bin < kSegment / 2; ++bin) {
      std::complex<double> sum = 0.0;
      for (int i = 0; i < kSegment; ++i) {
        sum += samples[static_cast<std::size_t>(i)] *
               std::polar(1.0, -2.0 * std::numbers::pi * bin * i / kSegment);
      }
      density[static_cast<std::size_t>(bin)] += 2.0 * std::norm(sum) / (kRate_Hz * kSegment * kSegments);
    }
  }
  for (int bin = 1; bin < kSegment / 2; ++bin) {
    // Each estimate has a relative standard deviation of 1/sqrt(256) = 6.25 %.
    EXPECT_NEAR(density[static_cast<std::size_t>(bin)], kDensity * kDensity, 4 * 0.0625 * kDensity * kDensity)
        << bin;
  }
}

TEST(WhiteNoise, IsZeroWithoutDensity) {
  WhiteNoise noise(0.0, 0.001, 1, "gyro");
  EXPECT_EQ(noise.sample(), Eigen::Vector3d::Zero());
}

TEST(Bias, IsDrawnUniformlyWithinItsBound) {
  double largest = 0.0;
  double smallest = 0.0;
  double mean = 0.0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Eigen::Vector3d value = Bias(0.35, seed, "gyro").value();
    largest = std::max(largest, value.maxCoeff());
    smallest = std::min(smallest, value.minCoeff());
    mean += value.mean() / 1000.0;
  }
  EXPECT_LE(largest, 0.35);
  EXPECT_GE(smallest, -0.35);
  EXPECT_GT(largest, 0.34);
  EXPECT_LT(smallest, -0.34);
  EXPECT_NEAR(mean, 0.0, 0.015);
}

TEST(Bias, DiffersByAxisAndName) {
  const Eigen::Vector3d gyro = Bias(1.0, 1, "gyro").value();
  const Eigen::Vector3d other = Bias(1.0, 1, "accelerometer").value();
  EXPECT_NE(gyro.x(), gyro.y());
  EXPECT_NE(gyro.y(), gyro.z());
  EXPECT_NE(gyro.x(), other.x());
}

}  // namespace
}  // namespace koboshi::sim_board
