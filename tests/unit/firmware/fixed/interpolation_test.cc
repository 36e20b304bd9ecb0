#include "firmware/fixed/interpolation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/fixed/literals.h"
#include "tests/support/seed.h"

namespace koboshi::fixed {
namespace {

using namespace literals;

using test::kSeed;

TEST(ElapsedFraction, RunsFromZeroToOne) {
  EXPECT_EQ(elapsed_fraction(0, 300'000), 0.0_ratio);
  EXPECT_EQ(elapsed_fraction(75'000, 300'000), 0.25_ratio);
  EXPECT_EQ(elapsed_fraction(300'000, 300'000), kOne);
  EXPECT_EQ(elapsed_fraction(1, 3).raw(), 357'913'941);  // 2^30 / 3 = 357913941.33
}

TEST(ElapsedFraction, ClampsOutsideItsDuration) {
  EXPECT_EQ(elapsed_fraction(300'001, 300'000), kOne);
  EXPECT_EQ(elapsed_fraction(-1, 300'000), 0.0_ratio);
  EXPECT_EQ(elapsed_fraction(0, 0), kOne);
  EXPECT_EQ(elapsed_fraction(5, -1), kOne);
}

TEST(Interpolate, DoesNotPassTheStopsOfAJoint) {
  EXPECT_EQ(interpolate(-170.0_deg, 170.0_deg, 0.5_ratio), 0.0_deg);
  EXPECT_EQ(interpolate(Angle::min(), Angle::max(), 0.0_ratio), Angle::min());
  EXPECT_EQ(interpolate(Angle::min(), Angle::max(), kOne), Angle::max());
  EXPECT_EQ(interpolate(Angle::max(), Angle::min(), 0.25_ratio).raw(), 0x3FFFFFFF);
}

TEST(Interpolate, StaysWithinOneLsbOfTheStraightLine) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 200'000; ++i) {
    const Angle from = Angle::from_raw(static_cast<std::int32_t>(random()));
    const Angle to = Angle::from_raw(static_cast<std::int32_t>(random()));
    const Ratio fraction = Ratio::from_raw(static_cast<std::int32_t>(random() >> 2));
    const long double exact =
        from.raw() + (static_cast<long double>(to.raw()) - from.raw()) * std::ldexp(fraction.raw(), -30);
    ASSERT_LE(std::abs(interpolate(from, to, fraction).raw() - exact), 0.5L);
  }
}

TEST(Interpolate, IsMonotone) {
  Length last = -0.3_m;
  for (int elapsed_us = 0; elapsed_us <= 10'000; ++elapsed_us) {
    const Length now = interpolate(-0.3_m, 0.2_m, elapsed_fraction(elapsed_us, 10'000));
    ASSERT_GE(now, last);
    last = now;
  }
  EXPECT_EQ(last, 0.2_m);
}

TEST(InterpolateHeading, TurnsTheShortWay) {
  EXPECT_EQ(interpolate_heading(-170.0_deg, 170.0_deg, 0.5_ratio), Angle::min());
  EXPECT_EQ(interpolate_heading(10.0_deg, 30.0_deg, 0.5_ratio), 20.0_deg);
  EXPECT_EQ(interpolate_heading(170.0_deg, -170.0_deg, kOne), -170.0_deg);
}

TEST(Rotation, IntegratesARate) {
  EXPECT_EQ(rotation(360.0_deg_per_s, 250'000), 90.0_deg);
  EXPECT_EQ(rotation(-360.0_deg_per_s, 250'000), -90.0_deg);
  EXPECT_EQ(rotation(360.0_deg_per_s, 1'000'000), 0.0_deg);
  EXPECT_EQ(rotation(AngularRate::from_raw(1), 10'000).raw(), 3);  // 2^-24 turn/s for 10 ms: 2.56 LSB
}

}  // namespace
}  // namespace koboshi::fixed
