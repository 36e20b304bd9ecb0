// Random moves against a reference in double precision, which is written from the formulas of the literature.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/firmware/motion/interpreter_fixture.h"

namespace koboshi::motion {
namespace {

constexpr double kEncoderStep_deg = 360.0 / 4096;

// A move of one joint between two knots.
struct Leg {
  Interpolation interpolation;
  double from_deg;
  double to_deg;
  double time_s;
};

// Flash and Hogan, "The coordination of arm movements", J. Neurosci. 5, 1985.
double minimum_jerk(const Leg& leg, double s) {
  return leg.from_deg +
         (leg.to_deg - leg.from_deg) * (10 * std::pow(s, 3) - 15 * std::pow(s, 4) + 6 * std::pow(s, 5));
}

// The integral of a trapezoid of speed whose three parts take equal times; its area is 1.
double trapezoid(double s) {
  constexpr double kPeak = 1.5;
  const double ramp_up = std::min(s, 1.0 / 3);
  const double ramp_down = std::max(s - 2.0 / 3, 0.0);
  const double constant = s - ramp_up - ramp_down;
  return kPeak * (1.5 * ramp_up * ramp_up + constant + ramp_down - 1.5 * ramp_down * ramp_down);
}

// The knot's slope in deg/s between two legs of a monotone cubic: Fritsch and Butland's weighted harmonic
// mean.
double slope(const Leg& before, const Leg& after) {
  if (before.interpolation != Interpolation::kCubic || after.interpolation != Interpolation::kCubic) return 0;
  const double d1 = (before.to_deg - before.from_deg) / before.time_s;
  const double d2 = (after.to_deg - after.from_deg) / after.time_s;
  if (d1 * d2 <= 0) return 0;
  const double alpha = (1 + after.time_s / (before.time_s + after.time_s)) / 3;
  return d1 * d2 / (alpha * d2 + (1 - alpha) * d1);
}

// The cubic Hermite polynomial.
double hermite(const Leg& leg, double start_slope, double end_slope, double s) {
  const double h00 = (1 + 2 * s) * (1 - s) * (1 - s);
  const double h10 = s * (1 - s) * (1 - s);
  const double h01 = s * s * (3 - 2 * s);
  const double h11 = s * s * (s - 1);
  return h00 * leg.from_deg + h10 * leg.time_s * start_slope + h01 * leg.to_deg +
         h11 * leg.time_s * end_slope;
}

double reference_deg(const std::vector<Leg>& legs, double time_s) {
  std::size_t i = 0;
  while (i + 1 < legs.size() && time_s > legs[i].time_s) time_s -= legs[i++].time_s;
  const Leg& leg = legs[i];
  const double s = std::min(time_s / leg.time_s, 1.0);
  switch (leg.interpolation) {
    case Interpolation::kLinear:
      return leg.from_deg + (leg.to_deg - leg.from_deg) * s;
    case Interpolation::kMinimumJerk:
      return minimum_jerk(leg, s);
    case Interpolation::kTrapezoid:
      return leg.from_deg + (leg.to_deg - leg.from_deg) * trapezoid(s);
    case Interpolation::kCubic:
      return hermite(leg, i > 0 ? slope(legs[i - 1], leg) : 0,
                     i + 1 < legs.size() ? slope(leg, legs[i + 1]) : 0, s);
  }
  return 0;
}

class InterpolationTest : public InterpreterTest {
 protected:
  // Plays `count` random moves of the knee, all of one kind unless `mixed`, and returns the largest deviation
  // from the reference in degrees.
  double play_random(std::uint32_t seed, int count, std::optional<Interpolation> kind, bool by_speed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    test::MotionBuilder builder(model_);
    std::vector<Leg> legs;
    double from_deg = 0;
    for (int i = 0; i < count; ++i) {
      const auto interpolation = kind ? *kind : static_cast<Interpolation>(random() % 4);
      // A way of 6 degrees takes 15 ms at 400 deg/s, so that one move by speed begins in a tick: of those
      // that are cubic the interpreter leaves a second one to the next tick (kMaxWork), where it begins at
      // rest.
      double to_deg = from_deg;
      do {
        to_deg = test::stored_deg(uniform(0, 120));
      } while (by_speed && std::abs(to_deg - from_deg) < 6);
      builder.pose(kKnee, to_deg);
      const double shortest_us = interpolation == Interpolation::kCubic ? 10'000 : 1'000;
      Leg leg{interpolation, from_deg, to_deg, std::floor(uniform(shortest_us, 2'000'000)) * 1e-6};
      Move move{.interpolation = interpolation,
                .pose = static_cast<std::uint16_t>(i),
                .value = static_cast<std::uint32_t>(std::lround(leg.time_s * 1e6))};
      if (by_speed) {
        const double speed_deg_per_s = uniform(20, 400);
        const double peak = interpolation == Interpolation::kLinear        ? 1.0
                            : interpolation == Interpolation::kMinimumJerk ? 15.0 / 8
                                                                           : 1.5;
        move.by_speed = true;
        move.value = static_cast<std::uint32_t>(std::lround(speed_deg_per_s / 360 * (1 << 24)));
        leg.time_s = std::max(0.001, std::abs(to_deg - from_deg) * peak / speed_deg_per_s);
      }
      builder.step(move.step());
      legs.push_back(leg);
      from_deg = to_deg;
    }
    start(builder.step(Opcode::kEnd));
    double time_s = 0;
    double largest_deg = 0;
    while (interpreter_.running() && time_s < 1'000) {
      const auto tick_us = 1'000 + static_cast<std::uint32_t>(random() % 9'000);
      interpreter_.advance(tick_us, inputs_);
      time_s += 1e-6 * tick_us;
      if (!interpreter_.running()) break;
      largest_deg = std::max(largest_deg, std::abs(knee_deg() - reference_deg(legs, time_s)));
    }
    EXPECT_FALSE(interpreter_.running());
    EXPECT_NEAR(knee_deg(), from_deg, 1e-6);
    return largest_deg;
  }
};

TEST_F(InterpolationTest, OfEachKindAgreesWithTheReferenceWithinOneEncoderStep) {
  for (const auto kind : {Interpolation::kLinear, Interpolation::kMinimumJerk, Interpolation::kCubic,
                          Interpolation::kTrapezoid}) {
    for (const bool by_speed : {false, true}) {
      double largest_deg = 0;
      for (std::uint32_t seed = 1; seed <= 20; ++seed)
        largest_deg = std::max(largest_deg, play_random(seed, 25, kind, by_speed));
      EXPECT_LT(largest_deg, kEncoderStep_deg)
          << int{static_cast<std::uint8_t>(kind)} << " by speed " << by_speed;
      RecordProperty("largest_" + std::to_string(static_cast<int>(kind)) + (by_speed ? "_by_speed" : ""),
                     std::to_string(largest_deg));
    }
  }
}

TEST_F(InterpolationTest, OfMixedKindsAgreesWithTheReferenceWithinOneEncoderStep) {
  for (std::uint32_t seed = 100; seed < 120; ++seed)
    EXPECT_LT(play_random(seed, 25, std::nullopt, false), kEncoderStep_deg) << "seed " << seed;
}

}  // namespace
}  // namespace koboshi::motion
