#include "sim_board/sensor/low_pass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace koboshi::sim_board {
namespace {

constexpr double kBandwidth_Hz = 98.0;

// Unit step of a 2nd-order Butterworth low-pass in closed form.
double step_response(double time_s) {
  const double decay = std::numbers::sqrt2 * std::numbers::pi * kBandwidth_Hz;
  return 1.0 - std::exp(-decay * time_s) * (std::cos(decay * time_s) + std::sin(decay * time_s));
}

double gain(double frequency_Hz) { return 1.0 / std::sqrt(1.0 + std::pow(frequency_Hz / kBandwidth_Hz, 4)); }

// Drives the filter with a sine of amplitude one and returns gain and phase of its steady output, by
// correlation over whole periods: frequency and step must divide a second.
std::complex<double> response(double frequency_Hz, std::uint64_t step_us) {
  LowPass filter(kBandwidth_Hz);
  filter.settle(Eigen::Vector3d::Zero());
  std::complex<double> sum = 0.0;
  const std::uint64_t steps = 1'000'000 / step_us;
  for (std::uint64_t i = 1; i <= 2 * steps; ++i) {
    const double phase = 2.0 * std::numbers::pi * frequency_Hz * static_cast<double>(i * step_us) * 1e-6;
    filter.advance(Eigen::Vector3d::Constant(std::sin(phase)), step_us);
    if (i > steps) sum += filter.output().y() * std::polar(2.0 / static_cast<double>(steps), -phase);
  }
  return sum * std::complex<double>(0.0, 1.0);
}

TEST(LowPass, StaysAtRestOnAConstant) {
  LowPass filter(kBandwidth_Hz);
  const Eigen::Vector3d value(1.0, -2.0, 3.0);
  filter.settle(value);
  for (int i = 0; i < 1000; ++i) filter.advance(value, 1000);
  EXPECT_LT((filter.output() - value).norm(), 1e-12);
}

TEST(LowPass, FollowsTheClosedFormOfAStep) {
  LowPass filter(kBandwidth_Hz);
  filter.settle(Eigen::Vector3d::Zero());
  filter.advance(Eigen::Vector3d::Ones(),
                 1);  // the edge: one microsecond, whose middle is when the step happens
  double largest = 0.0;
  for (int i = 1; i <= 50; ++i) {
    filter.advance(Eigen::Vector3d::Ones(), 500);
    const double expected = step_response(0.5e-6 + 500e-6 * i);
    largest = std::max(largest, filter.output().x());
    EXPECT_NEAR(filter.output().x(), expected, 1e-7) << i;
  }
  EXPECT_NEAR(largest, 1.0 + std::exp(-std::numbers::pi), 2e-3);  // the overshoot of 4.3 %
}

TEST(LowPass, HasTheGainAndPhaseOfAButterworthFilter) {
  for (const double frequency_Hz : {5.0, 20.0, 50.0, 98.0, 200.0, 400.0}) {
    const std::complex<double> s(0.0, frequency_Hz / kBandwidth_Hz);
    const std::complex<double> expected = 1.0 / (s * s + std::numbers::sqrt2 * s + 1.0);
    EXPECT_LT(std::abs(response(frequency_Hz, 50) - expected), 1.5e-3 * std::abs(expected)) << frequency_Hz;
  }
}

TEST(LowPass, AttenuatesAtOneKilohertzLikeLinearInterpolation) {
  for (const double frequency_Hz : {5.0, 20.0, 50.0, 98.0}) {
    const double x = std::numbers::pi * frequency_Hz * 1e-3;
    const double straight_lines = std::pow(std::sin(x) / x, 2);
    EXPECT_NEAR(std::abs(response(frequency_Hz, 1000)), gain(frequency_Hz) * straight_lines, 1e-3)
        << frequency_Hz;
  }
}

TEST(LowPass, DoesNotDependOnHowAStraightLineIsDivided) {
  LowPass whole(kBandwidth_Hz);
  LowPass divided(kBandwidth_Hz);
  whole.settle(Eigen::Vector3d::Zero());
  divided.settle(Eigen::Vector3d::Zero());
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d start = whole.input();
    const Eigen::Vector3d end(std::sin(i), std::cos(3 * i), i % 3);
    whole.advance(end, 1000);
    divided.advance(start + 0.137 * (end - start), 137);
    divided.advance(end, 863);
    EXPECT_LT((whole.output() - divided.output()).norm(), 1e-12);
  }
}

TEST(LowPass, RefusesABandwidthThatIsNotPositive) {
  EXPECT_THROW(LowPass(0.0), std::invalid_argument);
  EXPECT_THROW(LowPass(-1.0), std::invalid_argument);
  EXPECT_THROW(LowPass(std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::sim_board
