#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"
#include "tests/support/seed.h"

namespace koboshi::fixed {
namespace {

using namespace literals;

using test::kSeed;

// root^2 <= value < (root + 1)^2, in 64 bits.
bool is_floor_of_root(std::uint64_t value, std::uint64_t root) {
  return root * root <= value && value - root * root <= 2 * root;
}

TEST(IntegerSquareRoot, IsTheFloorForAll16BitNumbers) {
  for (std::uint32_t value = 0; value < 65'536; ++value) {
    ASSERT_TRUE(is_floor_of_root(value, integer_square_root(value))) << value;
  }
}

TEST(IntegerSquareRoot, IsTheFloorAroundSquares) {
  for (std::uint64_t root = 1; root < 65'536; ++root) {
    for (const std::uint64_t base : {root, root << 16, 0xFFFFFFFF - root}) {
      ASSERT_EQ(integer_square_root(base * base - 1), base - 1);
      ASSERT_EQ(integer_square_root(base * base), base);
      ASSERT_EQ(integer_square_root(base * base + 2 * base), base);
    }
  }
}

TEST(IntegerSquareRoot, IsTheFloorAtAllMagnitudes) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 1'000'000; ++i) {
    const std::uint64_t value = random() >> (i % 64);
    ASSERT_TRUE(is_floor_of_root(value, integer_square_root(value))) << value;
  }
  EXPECT_EQ(integer_square_root(0xFFFFFFFFFFFFFFFF), 0xFFFFFFFF);
}

TEST(IntegerSquareRoot, RoundsToNearest) {
  EXPECT_EQ(integer_square_root_rounded(6), 2U);
  EXPECT_EQ(integer_square_root_rounded(7), 3U);
  EXPECT_EQ(integer_square_root_rounded(0xFFFFFFFFFFFFFFFF), 0xFFFFFFFF);
  for (std::uint64_t root = 1; root < 65'536; ++root) {  // (root + 1/2)^2 = root^2 + root + 1/4
    ASSERT_EQ(integer_square_root_rounded(root * root + root), root);
    ASSERT_EQ(integer_square_root_rounded(root * root + root + 1), root + 1);
  }
}

TEST(SquareRoot, IsRoundedToNearestForAllUpperHalves) {
  for (std::int32_t upper = 0; upper < 32'768; ++upper) {
    const Ratio square = Ratio::from_raw(upper << 16 | 0x1234);
    const long double exact = std::sqrt(std::ldexp(static_cast<long double>(square.raw()), 30));
    ASSERT_LE(std::abs(square_root<Ratio>(square).raw() - exact), 0.5L) << square.raw();
  }
}

TEST(SquareRoot, ChangesFormats) {
  EXPECT_EQ(square_root<Gain>(1.5625_ratio), 1.25_gain);
  EXPECT_EQ(square_root<Ratio>(1.5625_gain), 1.25_ratio);
  EXPECT_EQ(square_root<Ratio>(9.0_gain), Ratio::max());
}

TEST(SquareRoot, OfANegativeNumberIsZero) {
  EXPECT_EQ(square_root<Ratio>(-0.5_ratio), 0.0_ratio);
  EXPECT_EQ(square_root<Ratio>(0.0_ratio), 0.0_ratio);
}

TEST(InverseSquareRoot, IsExactTo23BitsAtAllMagnitudes) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 1'000'000; ++i) {
    const std::uint64_t value = random() >> (i % 64);
    if (value == 0) continue;
    const InverseRoot root = inverse_square_root(value);
    ASSERT_GE(root.mantissa, (1U << 30) - 128);
    ASSERT_LE(root.mantissa, (1U << 31) + 256);
    const long double found = std::ldexp(static_cast<long double>(root.mantissa), -root.shift);
    ASSERT_LT(std::abs(found * std::sqrt(static_cast<long double>(value)) - 1.0L), std::ldexp(1.0L, -23))
        << value;
  }
}

TEST(Hypotenuse, IsRoundedToNearest) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const auto draw = [&] {
    return Length::from_raw(static_cast<std::int32_t>(random()) / 2 >> (random() % 30));
  };
  for (int i = 0; i < 200'000; ++i) {
    const Length x = draw();
    const Length y = draw();
    const Length z = draw();
    const auto square = [](Length q) { return static_cast<long double>(q.raw()) * q.raw(); };
    ASSERT_LE(std::abs(hypotenuse(x, y).raw() - std::sqrt(square(x) + square(y))), 0.5L + 1e-9L);
    ASSERT_LE(std::abs(hypotenuse(x, y, z).raw() - std::sqrt(square(x) + square(y) + square(z))),
              0.5L + 1e-9L);
  }
}

TEST(Hypotenuse, Saturates) {
  EXPECT_EQ(hypotenuse(0.03_m, -0.04_m), 0.05_m);
  EXPECT_EQ(hypotenuse(Length::min(), Length::min()), Length::max());
  EXPECT_EQ(hypotenuse(Length::min(), Length::min(), Length::min()), Length::max());
}

}  // namespace
}  // namespace koboshi::fixed
