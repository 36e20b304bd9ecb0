#include "sim_board/drive/motion_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace koboshi::sim_board {
namespace {

constexpr ProfileLimits kLimits{
    .velocity_units_per_s = 100.0, .acceleration_units_per_s2 = 200.0, .deceleration_units_per_s2 = 400.0};

TEST(MotionProfile, IsATrapezoid) {
  const MotionProfile profile(1'000.0, 0.0, kLimits);
  // 0.5 s and 25 units up, 0.25 s and 12.5 units down, the rest at 100 units/s.
  EXPECT_DOUBLE_EQ(profile.duration_s(), 0.5 + 9.625 + 0.25);
  EXPECT_DOUBLE_EQ(profile.distance_units(0.5), 25.0);
  EXPECT_DOUBLE_EQ(profile.speed_units_per_s(0.25), 50.0);
  EXPECT_DOUBLE_EQ(profile.speed_units_per_s(5.0), 100.0);
  EXPECT_DOUBLE_EQ(profile.distance_units(1.5), 125.0);
}

TEST(MotionProfile, IsATriangleOverAShortDistance) {
  const MotionProfile profile(-12.0, 0.0, kLimits);
  // v^2 (1/400 + 1/800) = 12: v is 56.6 units/s, up in 0.283 s and down in 0.141 s.
  const double top = std::sqrt(3'200.0);
  EXPECT_NEAR(profile.duration_s(), top / 200.0 + top / 400.0, 1e-12);
  EXPECT_NEAR(profile.speed_units_per_s(top / 200.0), -top, 1e-9);
  EXPECT_NEAR(profile.distance_units(profile.duration_s()), -12.0, 1e-9);
}

TEST(MotionProfile, StaysAtRestAtItsTarget) {
  const MotionProfile profile(0.0, 0.0, kLimits);
  EXPECT_EQ(profile.duration_s(), 0.0);
  EXPECT_EQ(profile.distance_units(0.0), 0.0);
}

TEST(MotionProfile, BrakesAndReturnsWhenItWouldOvershoot) {
  const MotionProfile profile(5.0, 80.0, kLimits);  // 80^2 / 800: 8 units to rest
  EXPECT_NEAR(profile.distance_units(0.2), 8.0, 1e-12);
  EXPECT_NEAR(profile.speed_units_per_s(0.2), 0.0, 1e-12);
  EXPECT_LT(profile.speed_units_per_s(0.21), 0.0);
  EXPECT_NEAR(profile.distance_units(profile.duration_s()), 5.0, 1e-9);
}

// 8 units to rest, 10 to go: it need not stop on the way.
TEST(MotionProfile, GoesOnWhereItCanStillStop) {
  const MotionProfile profile(10.0, 80.0, kLimits);
  EXPECT_GT(profile.speed_units_per_s(0.01), 80.0);
  for (double time_s = 0.0; time_s < profile.duration_s(); time_s += 0.001)
    EXPECT_GT(profile.speed_units_per_s(time_s), 0.0) << time_s;
}

// Whatever it starts with: it arrives, at rest, without a jump of position or speed, within its limits.
TEST(MotionProfile, KeepsItsLimitsOverAnyDistance) {
  constexpr unsigned kSeed = 402;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> way(-500.0, 500.0);
  std::uniform_real_distribution<double> speed(-150.0, 150.0);
  constexpr double kStep_s = 0.001;
  for (int run = 0; run < 500; ++run) {
    const double distance = way(random);
    const double start = speed(random);
    const MotionProfile profile(distance, start, kLimits);
    const double end_s = profile.duration_s();
    EXPECT_NEAR(profile.distance_units(0.0), 0.0, 1e-9);
    EXPECT_NEAR(profile.speed_units_per_s(0.0), start, 1e-9);
    for (double t_s = 0.0; t_s + kStep_s < end_s; t_s += kStep_s) {
      const double before = profile.speed_units_per_s(t_s);
      const double after = profile.speed_units_per_s(t_s + kStep_s);
      ASSERT_LE(std::abs(after - before), 400.0 * kStep_s + 1e-9);
      ASSERT_LE(std::abs(after), std::max(std::abs(before), 100.0) + 1e-9);
      const double moved = profile.distance_units(t_s + kStep_s) - profile.distance_units(t_s);
      ASSERT_NEAR(moved, 0.5 * (before + after) * kStep_s, 400.0 * kStep_s * kStep_s);
    }
    EXPECT_NEAR(profile.distance_units(end_s), distance, 1e-6);
    EXPECT_NEAR(profile.speed_units_per_s(end_s), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace koboshi::sim_board
