#include "firmware/fixed/trigonometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "firmware/fixed/literals.h"
#include "tests/support/seed.h"

namespace koboshi::fixed {
namespace {

using namespace literals;
using testing::AllOf;
using testing::Gt;
using testing::Le;

using test::kSeed;
constexpr int kRandomAngles = 1'000'000;
constexpr long double kTwoPi = 2.0L * std::numbers::pi_v<long double>;
constexpr long double kLsbPerRad = 4294967296.0L / kTwoPi;  // scale of Angle
constexpr long double kLsbPerOne = 1073741824.0L;           // scale of Ratio

// Bounds in LSB of the result: the measured error plus a tenth. Rounding alone gives up to half an LSB, so a
// smaller maximum would mean that the test does not compare.
constexpr long double kSineBound_lsb = 1.4L;
constexpr long double kArcTangentBound_lsb = 1.7L;
constexpr long double kArcSineBound_lsb = 2.0L;

class MaximumError {
 public:
  void add(std::int32_t actual_raw, long double exact_raw) {
    maximum_ = std::max(maximum_, std::abs(static_cast<long double>(actual_raw) - exact_raw));
  }
  // Half a turn and its negative are the same angle.
  void add_angle(Angle actual, long double exact_rad) {
    const long double error = actual.raw() - exact_rad * kLsbPerRad;
    maximum_ = std::max(maximum_, std::abs(std::remainder(error, 4294967296.0L)));
  }
  long double value() const { return maximum_; }

 private:
  long double maximum_ = 0.0L;
};

long double rad(Angle angle) { return angle.raw() / kLsbPerRad; }

// Runs over the 65536 angles or ratios whose lower half is zero, and their neighbours.
template <typename Q, typename Check>
void for_upper_halves(Check check) {
  for (std::int64_t upper = -32'768; upper <= 32'767; ++upper) {
    for (std::int64_t offset = -1; offset <= 1; ++offset) {
      check(Q::from_raw(saturate<std::int32_t>(upper * 65'536 + offset)));
    }
  }
}

template <typename Q, typename Check>
void for_random(Check check) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < kRandomAngles; ++i) check(Q::from_raw(static_cast<std::int32_t>(random())));
}

template <typename Q, typename Check>
void for_domain(Check check) {
  for_upper_halves<Q>(check);
  for_random<Q>(check);
}

TEST(Sine, KeepsItsErrorBound) {
  MaximumError error;
  for_domain<Angle>([&](Angle a) { error.add(sin(a).raw(), std::sin(rad(a)) * kLsbPerOne); });
  EXPECT_THAT(error.value(), AllOf(Gt(0.5L), Le(kSineBound_lsb)));
}

TEST(Cosine, KeepsItsErrorBound) {
  MaximumError error;
  for_domain<Angle>([&](Angle a) { error.add(cos(a).raw(), std::cos(rad(a)) * kLsbPerOne); });
  EXPECT_THAT(error.value(), AllOf(Gt(0.5L), Le(kSineBound_lsb)));
}

TEST(Sine, IsExactAtTheQuarters) {
  EXPECT_EQ(sin(0.0_deg), 0.0_ratio);
  EXPECT_EQ(sin(90.0_deg), 1.0_ratio);
  EXPECT_EQ(sin(-90.0_deg), -1.0_ratio);
  EXPECT_EQ(sin(Angle::min()), 0.0_ratio);
  EXPECT_EQ(cos(0.0_deg), 1.0_ratio);
  EXPECT_EQ(cos(90.0_deg), 0.0_ratio);
  EXPECT_EQ(cos(Angle::min()), -1.0_ratio);
}

TEST(Sine, MirrorsLeftAndRightToTheBit) {
  for_domain<Angle>([](Angle a) {
    ASSERT_EQ(sin(-a), -sin(a)) << a.raw();
    ASSERT_EQ(cos(-a), cos(a)) << a.raw();
    ASSERT_EQ(sin(Angle::min() - a), sin(a)) << a.raw();
  });
}

TEST(Sine, RisesOverTheHalfTurn) {
  // Monotonic everywhere at a coarse step, and LSB by LSB where the function is flat and where the two
  // kernels meet.
  const auto expect_rising = [](std::int64_t from_raw, std::int64_t to_raw, std::int64_t step_raw) {
    Ratio last = -kOne;
    for (std::int64_t raw = from_raw; raw <= to_raw; raw += step_raw) {
      const Ratio now = sin(Angle::from_raw(static_cast<std::int32_t>(raw)));
      ASSERT_GE(now, last) << raw;
      last = now;
    }
  };
  expect_rising(-(1 << 30), 1 << 30, 1 << 10);
  expect_rising((1 << 30) - 200'000, 1 << 30, 1);
  expect_rising((1 << 29) - 100'000, (1 << 29) + 100'000, 1);
  expect_rising(-100'000, 100'000, 1);
}

TEST(SineCosine, EqualTheSingleFunctions) {
  for_domain<Angle>([](Angle a) {
    const SineCosine both = sin_cos(a);
    ASSERT_EQ(both.sine, sin(a)) << a.raw();
    ASSERT_EQ(both.cosine, cos(a)) << a.raw();
  });
}

TEST(ArcTangent, KeepsItsErrorBoundOnAGridOfAllDirections) {
  MaximumError error;
  for (std::int32_t y = -128; y < 128; ++y) {
    for (std::int32_t x = -128; x < 128; ++x) {
      if (x == 0 && y == 0) continue;
      for (const std::int32_t scale : {1, 257, 1 << 24}) {
        error.add_angle(atan2(Length::from_raw(y * scale), Length::from_raw(x * scale)),
                        std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
      }
    }
  }
  EXPECT_THAT(error.value(), AllOf(Gt(0.5L), Le(kArcTangentBound_lsb)));
}

TEST(ArcTangent, KeepsItsErrorBoundAtAllMagnitudes) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const auto draw = [&] { return static_cast<std::int32_t>(random()) >> (random() % 31); };
  MaximumError error;
  for (int i = 0; i < kRandomAngles; ++i) {
    const std::int32_t y = draw();
    const std::int32_t x = draw();
    if (x == 0 && y == 0) continue;
    error.add_angle(atan2_raw(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
  }
  EXPECT_THAT(error.value(), AllOf(Gt(0.5L), Le(kArcTangentBound_lsb)));
}

TEST(ArcTangent, IsExactOnAxesAndDiagonals) {
  constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
  for (const std::int32_t r : {1, 7, 1 << 24, 0x7FFFFFFF}) {
    EXPECT_EQ(atan2_raw(0, r), 0.0_deg);
    EXPECT_EQ(atan2_raw(r, r), 45.0_deg);
    EXPECT_EQ(atan2_raw(r, 0), 90.0_deg);
    EXPECT_EQ(atan2_raw(r, -r), 135.0_deg);
    EXPECT_EQ(atan2_raw(0, -r), Angle::min());
    EXPECT_EQ(atan2_raw(-r, -r), -135.0_deg);
    EXPECT_EQ(atan2_raw(-r, 0), -90.0_deg);
    EXPECT_EQ(atan2_raw(-r, r), -45.0_deg);
  }
  EXPECT_EQ(atan2_raw(kMin, kMin), -135.0_deg);
  EXPECT_EQ(atan2_raw(0, kMin), Angle::min());
  EXPECT_EQ(atan2_raw(0, 0), 0.0_deg);
}

TEST(ArcTangent, MirrorsLeftAndRightToTheBit) {
  std::mt19937 random(kSeed);
  for (int i = 0; i < 100'000; ++i) {
    const std::int32_t y = static_cast<std::int32_t>(random()) | 1;
    const std::int32_t x = static_cast<std::int32_t>(random()) | 1;
    ASSERT_EQ(atan2_raw(-y, x), -atan2_raw(y, x));
    ASSERT_EQ(atan2_raw(y, -x), Angle::min() - atan2_raw(y, x));
  }
}

TEST(ArcTangent, DoesNotFallBetweenItsSegments) {
  for (std::int32_t boundary = 1; boundary < 16; ++boundary) {
    const std::int32_t centre = boundary << 27;
    Angle last = atan2_raw(centre - 2'001, 0x7FFFFFFF);
    for (std::int32_t y = centre - 2'000; y <= centre + 2'000; ++y) {
      const Angle now = atan2_raw(y, 0x7FFFFFFF);
      ASSERT_GE((now - last).raw(), -1) << y;
      last = now;
    }
  }
}

long double clamped(Ratio ratio) { return std::clamp(ratio.raw() / kLsbPerOne, -1.0L, 1.0L); }

TEST(ArcSine, KeepsItsErrorBound) {
  MaximumError error;
  const auto check = [&](Ratio r) { error.add(asin(r).raw(), std::asin(clamped(r)) * kLsbPerRad); };
  for_domain<Ratio>(check);
  for (std::int32_t below = 0; below < 65'536; ++below) check(kOne - Ratio::from_raw(below));
  EXPECT_THAT(error.value(), AllOf(Gt(0.5L), Le(kArcSineBound_lsb)));
}

TEST(ArcCosine, KeepsItsErrorBound) {
  MaximumError error;
  const auto check = [&](Ratio r) { error.add(acos(r).raw(), std::acos(clamped(r)) * kLsbPerRad); };
  for_domain<Ratio>(check);
  for (std::int32_t below = 0; below < 65'536; ++below) {
    check(kOne - Ratio::from_raw(below));
    check(Ratio::from_raw(below) - kOne);
  }
  EXPECT_THAT(error.value(), AllOf(Gt(0.5L), Le(kArcSineBound_lsb)));
}

TEST(ArcSine, IsDefinedBeyondOne) {
  EXPECT_EQ(asin(Ratio::max()), 90.0_deg);
  EXPECT_EQ(asin(Ratio::min()), -90.0_deg);
  EXPECT_EQ(acos(Ratio::max()), 0.0_deg);
  EXPECT_EQ(acos(0.0_ratio), 90.0_deg);
  EXPECT_EQ(acos(-1.0_ratio), Angle::max());
  EXPECT_EQ(acos(Ratio::min()), Angle::max());
}

}  // namespace
}  // namespace koboshi::fixed
