#include "lab/trial/loop_gain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace koboshi::lab {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;
constexpr double kStep_s = 1e-3;

// A known loop: the gain K times a second-order low-pass filter, behind a delay.
//   L(s) = K exp(-s T) / (1 + 2 z s / w0 + s^2 / w0^2)
struct KnownLoop {
  double gain = 3.0;
  double corner_rad_per_s = kTau * 4.0;
  double damping = 0.7;
  int delay_steps = 0;

  std::complex<double> response(double frequency_Hz) const {
    const std::complex<double> s(0.0, kTau * frequency_Hz / corner_rad_per_s);
    const std::complex<double> delay =
        std::polar(1.0, -kTau * frequency_Hz * (static_cast<double>(delay_steps) * kStep_s));
    return gain * delay / (1.0 + 2.0 * damping * s + s * s);
  }
};

// Steps the closed loop w = -L (w + d), as the experiment does, and measures L.
std::complex<double> measured(const KnownLoop& loop, double frequency_Hz) {
  constexpr double kAmplitude = 0.5;
  constexpr double kBegin_s = 4.0;
  const double end_s = kBegin_s + std::ceil(std::max(8.0, 4.0 * frequency_Hz)) / frequency_Hz;
  std::vector<double> line(static_cast<std::size_t>(loop.delay_steps) + 1);
  SineCorrelator rate(frequency_Hz);
  double position = 0.0;
  double speed = 0.0;
  constexpr int kParts = 20;  // of a step, so that the integration is much better than the comparison
  for (int i = 0; i * kStep_s < end_s; ++i) {
    const double time_s = i * kStep_s;
    line[static_cast<std::size_t>(i) % line.size()] = position;
    const double w = -line[static_cast<std::size_t>(i + 1) % line.size()];
    if (time_s >= kBegin_s) rate.add(time_s, w);
    // Like every sampled input, it is held for a step.
    const double input = loop.gain * (w + kAmplitude * std::cos(kTau * frequency_Hz * time_s));
    for (int part = 0; part < kParts; ++part) {
      const double w0 = loop.corner_rad_per_s;
      const double h = kStep_s / kParts;
      speed += h * (w0 * w0 * (input - position) - 2.0 * loop.damping * w0 * speed);
      position += h * speed;
    }
  }
  const std::complex<double> w = rate.amplitude();
  return -w / (w + kAmplitude);
}

TEST(LoopGain, OfAKnownSecondOrderFilterIsMeasuredInTheClosedLoop) {
  const KnownLoop loop{.delay_steps = 5};
  for (const double frequency_Hz : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
    const std::complex<double> found = measured(loop, frequency_Hz);
    // An input that is held for a step is late by half a step.
    const std::complex<double> expected =
        loop.response(frequency_Hz) * std::polar(1.0, -kTau * frequency_Hz * 0.5 * kStep_s);
    EXPECT_NEAR(std::abs(found / expected - 1.0), 0.0, 0.01) << frequency_Hz;
  }
}

TEST(LoopGain, MarginsAreThoseOfTheKnownLoop) {
  const KnownLoop loop{.delay_steps = 12};
  std::vector<LoopPoint> points;
  for (double frequency_Hz = 0.5; frequency_Hz < 30.0; frequency_Hz *= 1.1)
    points.push_back({frequency_Hz, loop.response(frequency_Hz)});
  const LoopMargins margins = margins_of(points);
  // Solved by bisection, independently of the code.
  const auto root = [](double low, double high, const auto& falls_below) {
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (falls_below(middle) ? high : low) = middle;
    }
    return low;
  };
  const double crossover_Hz = root(0.5, 30.0, [&](double f) { return std::abs(loop.response(f)) < 1.0; });
  const auto phase_deg = [&](double f) {  // of the filter, and of the delay
    return 360.0 / kTau * std::arg(KnownLoop{.delay_steps = 0}.response(f)) -
           360.0 * f * loop.delay_steps * kStep_s;
  };
  const double phase_crossover_Hz = root(0.5, 30.0, [&](double f) { return phase_deg(f) < -180.0; });
  ASSERT_TRUE(margins.crossover_Hz && margins.phase_crossover_Hz);
  EXPECT_NEAR(*margins.crossover_Hz, crossover_Hz, 0.01 * crossover_Hz);
  EXPECT_NEAR(*margins.phase_margin_deg, 180.0 + phase_deg(crossover_Hz), 1.0);
  EXPECT_NEAR(*margins.phase_crossover_Hz, phase_crossover_Hz, 0.01 * phase_crossover_Hz);
  EXPECT_NEAR(*margins.gain_margin, 1.0 / std::abs(loop.response(phase_crossover_Hz)), 0.02);
}

TEST(LoopGain, HasNoMarginsWhereTheGainStaysBelowOne) {
  const std::vector<LoopPoint> points{{1.0, {0.5, 0.0}}, {2.0, {0.3, -0.2}}};
  const LoopMargins margins = margins_of(points);
  EXPECT_FALSE(margins.crossover_Hz || margins.phase_margin_deg || margins.gain_margin);
  EXPECT_NEAR(margins.distance, std::abs(std::complex<double>(1.3, -0.2)), 1e-12);
}

TEST(LoopGain, PhasesContinueBeyondHalfATurn) {
  std::vector<LoopPoint> points;
  for (int i = 0; i < 8; ++i) points.push_back({1.0 + i, std::polar(1.0, -1.0 * i)});
  const std::vector<double> phases = unwrapped_phases_deg(points);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(phases[static_cast<std::size_t>(i)], -360.0 / kTau * i, 1e-9);
}

TEST(SineCorrelator, SeesOneSineAmongOthersAndAConstant) {
  SineCorrelator correlator(2.0);
  for (int i = 0; i < 4000; ++i) {
    const double t = i * kStep_s;
    correlator.add(t, 5.0 + 0.3 * std::cos(kTau * 2.0 * t + 0.4) + 2.0 * std::cos(kTau * 3.0 * t));
  }
  EXPECT_NEAR(std::abs(correlator.amplitude() - std::polar(0.3, 0.4)), 0.0, 1e-9);
}

}  // namespace
}  // namespace koboshi::lab
