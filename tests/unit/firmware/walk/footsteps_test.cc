#include "firmware/walk/footsteps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/fixed/host/convert.h"
#include "firmware/walk/pendulum.h"

namespace koboshi::walk {
namespace {

using fixed::Angle;
using fixed::from_double;
using fixed::Length;
using fixed::to_double;
using hal::Side;

// A random gait with its steps and the matching pendulum.
struct RandomGait {
  explicit RandomGait(std::mt19937& random)
      : pendulum(from_double<Length>(std::uniform_real_distribution(0.14, 0.2)(random))),
        ticks(std::uniform_int_distribution(16, 40)(random)),
        double_ticks(std::uniform_int_distribution(0, ticks / 3)(random)),
        width(from_double<Length>(std::uniform_real_distribution(0.04, 0.1)(random))),
        steps(width, pendulum.growth(static_cast<std::size_t>(ticks)), pendulum.lag(double_ticks)) {}

  // Returns the DCM at the end of a step, given the ZMP under the support foot. The ZMP shifts from the
  // previous foot, which is `last_step` behind.
  Point end_of_step(Point begin, Point last_step) const {
    PendulumState state = PendulumState::at_rest(begin);
    for (std::int32_t tick = 1; tick <= ticks; ++tick) {
      const std::int32_t missing = std::max(double_ticks + 1 - tick, 0);
      const auto behind = [&](Length step) { return -(step * missing / (double_ticks + 1)); };
      pendulum.advance(state, {behind(last_step.x), behind(last_step.y)});
    }
    return state.dcm;
  }

  Pendulum pendulum;
  std::int32_t ticks;
  std::int32_t double_ticks;
  Length width;
  Footsteps steps;
};

Stride random_stride(std::mt19937& random) {
  const auto length = [&](double most_m) {
    return from_double<Length>(std::uniform_real_distribution(-most_m, most_m)(random));
  };
  return {.distance = {length(0.1), length(0.04)},
          .turn = from_double<Angle>(std::uniform_real_distribution(-0.4, 0.4)(random))};
}

Stride mirrored(const Stride& stride) {
  return {.distance = {stride.distance.x, -stride.distance.y}, .turn = -stride.turn};
}

std::int32_t difference_raw(Length a, Length b) { return std::abs((a - b).raw()); }

TEST(Footsteps, AdvanceByDistanceAndTurnInEachOfTwoSteps) {
  std::mt19937 random{20081};
  for (int round = 0; round < 1'000; ++round) {
    const RandomGait gait(random);
    const Stride stride = random_stride(random);
    const Foothold left = gait.steps.step(Side::kLeft, stride);
    const Foothold right = gait.steps.step(Side::kRight, stride);
    EXPECT_EQ(left.p + right.p, (Point{stride.distance.x * 2, stride.distance.y * 2}));
    EXPECT_EQ(left.yaw + right.yaw, stride.turn * 2);
  }
}

TEST(Footsteps, OpenWithTheFootOnTheSideOfTheMotionAndTurnWithBoth) {
  const Length width = from_double<Length>(0.06);
  const Footsteps steps(width, from_double<fixed::Gain>(7.0), {});
  const Stride stride{.distance = {{}, from_double<Length>(0.01)}, .turn = from_double<Angle>(0.1)};
  EXPECT_EQ(steps.step(Side::kLeft, stride).p.y, width + stride.distance.y * 2);
  EXPECT_EQ(steps.step(Side::kLeft, stride).yaw, stride.turn);
  EXPECT_EQ(steps.step(Side::kRight, stride).p.y, -width);
  EXPECT_EQ(steps.step(Side::kRight, stride).yaw, stride.turn);
}

TEST(Footsteps, AreMirroredToTheBit) {
  std::mt19937 random{20081};
  for (int round = 0; round < 10'000; ++round) {
    const RandomGait gait(random);
    const Stride stride = random_stride(random);
    const Foothold left = gait.steps.step(Side::kLeft, stride);
    const Foothold right = gait.steps.step(Side::kRight, mirrored(stride));
    ASSERT_EQ(left.p, (Point{right.p.x, -right.p.y}));
    ASSERT_EQ(left.yaw, -right.yaw);
  }
}

// Half an LSB is rounded upwards on both sides, so each of the four roundings may cause a difference of one
// LSB.
TEST(FootstepsOffset, IsMirroredToFourLsb) {
  std::mt19937 random{20081};
  std::int32_t worst_raw = 0;
  for (int round = 0; round < 10'000; ++round) {
    const RandomGait gait(random);
    const Stride stride = random_stride(random);
    const Point left = gait.steps.offset(Side::kLeft, stride);
    const Point right = gait.steps.offset(Side::kRight, mirrored(stride));
    worst_raw = std::max({worst_raw, difference_raw(left.x, right.x), difference_raw(left.y, -right.y)});
  }
  EXPECT_LE(worst_raw, 4);
}

TEST(FootstepsOffset, IsPeriodicOverTwoSteps) {
  std::mt19937 random{20081};
  double worst_m = 0.0;
  for (int round = 0; round < 2'000; ++round) {
    const RandomGait gait(random);
    const Stride stride = random_stride(random);
    for (const Side stance : {Side::kLeft, Side::kRight}) {
      const Point next = gait.steps.step(other(stance), stride).p;
      const Point last = gait.steps.step(stance, stride).p;
      const Point end = gait.end_of_step(gait.steps.offset(stance, stride), last) - next;
      const Point expected = gait.steps.offset(other(stance), stride);
      worst_m = std::max(
          {worst_m, std::abs(to_double(end.x - expected.x)), std::abs(to_double(end.y - expected.y))});
    }
  }
  EXPECT_LT(worst_m, 20e-6);
  EXPECT_GT(worst_m, 1e-8);
}

// Marching on the spot in single support only: the offset is half the width divided by (growth + 1), from the
// middle between the feet.
TEST(FootstepsOffset, OnTheSpotEqualsTheTextbook) {
  const double growth = 7.0;
  const double width_m = 0.062;
  const Footsteps steps(from_double<Length>(width_m), from_double<fixed::Gain>(growth), {});
  EXPECT_NEAR(to_double(steps.offset(Side::kRight, {}).y), width_m / (growth + 1.0), 1e-7);
  EXPECT_NEAR(to_double(steps.offset(Side::kLeft, {}).y), -width_m / (growth + 1.0), 1e-7);
}

}  // namespace
}  // namespace koboshi::walk
