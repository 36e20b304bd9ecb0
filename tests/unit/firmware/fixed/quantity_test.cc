#include "firmware/fixed/quantity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/units.h"
#include "tests/support/seed.h"

namespace koboshi::fixed {
namespace {

using namespace literals;

using test::kSeed;
constexpr int kRandomQuantities = 200'000;

// Random raw values of all magnitudes and both signs.
class RandomRaw {
 public:
  std::int32_t operator()() { return static_cast<std::int32_t>(generator_()) >> (generator_() % 31); }

 private:
  std::mt19937 generator_{kSeed};
};

template <typename A, typename B>
concept Addable = requires(A a, B b) {
  a + b;
};
template <typename A, typename B>
concept Subtractable = requires(A a, B b) {
  a - b;
};
template <typename A, typename B>
concept Comparable = requires(A a, B b) {
  a < b;
};
template <typename A, typename B>
concept EqualityComparable = requires(A a, B b) {
  a == b;
};
template <typename A, typename B>
concept Multipliable = requires(A a, B b) {
  a* b;
};
template <typename A, typename B>
concept Divisible = requires(A a, B b) {
  a / b;
};

template <typename A, typename B>
constexpr bool kMix = Addable<A, B> || Subtractable<A, B> || Comparable<A, B> || EqualityComparable<A, B> ||
                      Multipliable<A, B> || Divisible<A, B> || std::is_convertible_v<A, B> ||
                      std::is_constructible_v<A, B> || std::is_assignable_v<A&, B>;

template <typename A, typename... Others>
constexpr bool kMixesWithAny = (kMix<A, Others> || ...);

static_assert(!kMixesWithAny<Angle, AngularRate, Length, Torque, Force, Acceleration, Mass, Gain, Ratio>);
static_assert(!kMixesWithAny<AngularRate, Angle, Length, Torque, Force, Acceleration, Mass, Gain, Ratio>);
static_assert(!kMixesWithAny<Length, Angle, AngularRate, Torque, Force, Acceleration, Mass, Gain, Ratio>);
static_assert(!kMixesWithAny<Torque, Angle, AngularRate, Length, Force, Acceleration, Mass, Gain, Ratio>);
static_assert(!kMixesWithAny<Ratio, Angle, AngularRate, Length, Torque, Force, Acceleration, Mass, Gain>);
static_assert(Addable<Angle, Angle> && Subtractable<Angle, Angle> && Comparable<Angle, Angle>);
static_assert(!Multipliable<Ratio, Ratio> && !Divisible<Length, Length>, "products and quotients are named");
static_assert(Multipliable<Length, int> && Multipliable<std::int16_t, Length> &&
              Divisible<Length, std::uint8_t>);
static_assert(!Multipliable<Length, double> && !Multipliable<float, Length> && !Divisible<Length, double>);
static_assert(!Multipliable<Length, std::uint32_t> && !Multipliable<Length, std::int64_t>, "would lose bits");
static_assert(!std::is_constructible_v<Length, int> && !std::is_convertible_v<Length, int>);
static_assert(sizeof(Angle) == 4 && std::is_trivially_copyable_v<Angle>);

TEST(Quantity, IsZeroAtFirst) { EXPECT_EQ(Length().raw(), 0); }

TEST(Quantity, WrapsAngles) {
  EXPECT_EQ(135.0_deg + 90.0_deg, -135.0_deg);
  EXPECT_EQ(-135.0_deg - 90.0_deg, 135.0_deg);
  EXPECT_EQ(-Angle::min(), Angle::min());
  EXPECT_EQ(90.0_deg * 3, -90.0_deg);
  EXPECT_EQ(Angle::from_wide_raw(std::int64_t{1} << 32), 0.0_deg);
  EXPECT_EQ(product<Angle>(135.0_deg, 1.5_ratio), -157.5_deg);
}

TEST(Quantity, SaturatesEverythingElse) {
  EXPECT_EQ(Length::max() + 0.001_m, Length::max());
  EXPECT_EQ(Length::min() - 0.001_m, Length::min());
  EXPECT_EQ(-Length::min(), Length::max());
  EXPECT_EQ(100.0_m * 2, Length::max());
  EXPECT_EQ(-2 * 100.0_m, Length::min());
  EXPECT_EQ(Length::min() / -1, Length::max());
  EXPECT_EQ(product<Length>(100.0_m, -1.5_ratio), Length::min());
  EXPECT_EQ(quotient<Ratio>(3.0_m, 1.0_m), Ratio::max());
}

TEST(Quantity, AddsAndSubtractsInPlace) {
  Torque torque = 1.0_Nm;
  torque += 0.5_Nm;
  EXPECT_EQ(torque, 1.5_Nm);
  torque -= 2.0_Nm;
  EXPECT_EQ(torque, -0.5_Nm);
}

TEST(Quantity, ComparesByValue) {
  EXPECT_LT(-0.1_m, 0.1_m);
  EXPECT_GE(0.1_m, 0.1_m);
  EXPECT_NE(0.1_m, Length::from_raw((0.1_m).raw() + 1));
}

TEST(Quantity, RoundsDivisionToNearestAwayFromZero) {
  EXPECT_EQ((Length::from_raw(5) / 2).raw(), 3);
  EXPECT_EQ((Length::from_raw(-5) / 2).raw(), -3);
  EXPECT_EQ((Length::from_raw(4) / 3).raw(), 1);
  EXPECT_EQ((Length::from_raw(5) / -3).raw(), -2);
}

TEST(Quantity, HasAMagnitudeThatSaturates) {
  EXPECT_EQ(abs(-0.5_m), 0.5_m);
  EXPECT_EQ(abs(0.5_m), 0.5_m);
  EXPECT_EQ(abs(Length::min()), Length::max());
  EXPECT_EQ(abs(Angle::min()), Angle::max());
}

std::int64_t nearest(long double value) { return static_cast<std::int64_t>(std::round(value)); }

TEST(Quantity, RoundsProductsOnce) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomRaw random;
  for (int i = 0; i < kRandomQuantities; ++i) {
    const Length a = Length::from_raw(random());
    const Ratio b = Ratio::from_raw(random());
    const std::int64_t exact =
        nearest(std::ldexp(static_cast<long double>(a.raw()) * b.raw(), -Ratio::kFractionBits));
    ASSERT_EQ(product<Length>(a, b).raw(), saturate<std::int32_t>(exact)) << a.raw() << " * " << b.raw();
    ASSERT_EQ(product<Length>(b, a), product<Length>(a, b));
    if (a != Length::min()) {
      ASSERT_EQ(product<Angle>(Gain::from_raw(-a.raw()), b), -product<Angle>(Gain::from_raw(a.raw()), b));
    }
  }
}

TEST(Quantity, RoundsSumsOfProductsOnce) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomRaw random;
  for (int i = 0; i < kRandomQuantities; ++i) {
    const Length a0 = Length::from_raw(random() / 2);
    const Length a1 = Length::from_raw(random() / 2);
    const Ratio b0 = Ratio::from_raw(random());
    const Ratio b1 = Ratio::from_raw(random());
    const long double sum =
        static_cast<long double>(a0.raw()) * b0.raw() + static_cast<long double>(a1.raw()) * b1.raw();
    ASSERT_EQ(product_sum<Length>(a0, b0, a1, b1).raw(),
              saturate<std::int32_t>(nearest(std::ldexp(sum, -Ratio::kFractionBits))));
  }
  EXPECT_EQ(product_sum<Length>(Length::min(), Ratio::min(), Length::min(), Ratio::min()), Length::max());
  EXPECT_EQ(product_sum<Length>(Length::max(), Ratio::min(), Length::max(), Ratio::min()), Length::min());
}

TEST(Quantity, RoundsQuotientsOnce) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomRaw random;
  for (int i = 0; i < kRandomQuantities; ++i) {
    const Length a = Length::from_raw(random());
    const Length b = Length::from_raw(random());
    if (b == Length()) continue;
    const long double exact = std::ldexp(static_cast<long double>(a.raw()), Ratio::kFractionBits) / b.raw();
    ASSERT_EQ(quotient<Ratio>(a, b).raw(), saturate<std::int32_t>(nearest(exact)))
        << a.raw() << " / " << b.raw();
  }
}

TEST(Quantity, DividesAcrossFormats) {
  EXPECT_EQ(quotient<Acceleration>(10.0_N, 4.0_kg), 2.5_m_per_s2);
  EXPECT_EQ(quotient<Length>(1.0_Nm, 8.0_N), 0.125_m);
  EXPECT_EQ(quotient<Force>(1.0_Nm, 0.5_m), 2.0_N);
  EXPECT_EQ(quotient<Gain>(0.25_ratio, 0.5_ratio), 0.5_gain);
  EXPECT_EQ(quotient<Gain>(45.0_deg, 90.0_deg), 0.5_gain);
}

TEST(Quantity, DefinesDivisionByZero) {
  EXPECT_EQ(quotient<Ratio>(1.0_m, 0.0_m), Ratio::max());
  EXPECT_EQ(quotient<Ratio>(-1.0_m, 0.0_m), Ratio::min());
  EXPECT_EQ(quotient<Ratio>(0.0_m, 0.0_m), 0.0_ratio);
  EXPECT_EQ(quotient<Angle>(1.0_ratio, 0.0_gain), Angle::max());
  EXPECT_EQ(mul_div(1.0_m, -1, 0), Length::min());
  EXPECT_EQ(mul_div(45.0_deg, -1, 0), Angle::min());
  EXPECT_EQ(1.0_m / 0, Length::max());
}

TEST(Quantity, MultipliesAndDividesWithOneRounding) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomRaw random;
  for (int i = 0; i < kRandomQuantities; ++i) {
    const Torque a = Torque::from_raw(random());
    const std::int32_t numerator = random();
    const std::int32_t denominator = random();
    if (denominator == 0) continue;
    const std::int64_t exact = nearest(static_cast<long double>(a.raw()) * numerator / denominator);
    ASSERT_EQ(mul_div(a, numerator, denominator).raw(), saturate<std::int32_t>(exact));
  }
}

}  // namespace
}  // namespace koboshi::fixed
