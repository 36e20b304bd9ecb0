#include "firmware/fixed/rounding.h"

#include <gtest/gtest.h>

#include <cmath>

namespace koboshi::fixed {
namespace {

TEST(ShiftRounded, RoundsToNearestAwayFromZero) {
  for (int shift = 0; shift <= 18; ++shift) {
    for (int value = -65'536; value <= 65'536; ++value) {
      ASSERT_EQ(shift_rounded(value, shift), std::lround(std::ldexp(value, -shift)))
          << value << " >> " << shift;
    }
  }
}

TEST(ShiftRounded, HoldsAtItsLimits) {
  constexpr std::int64_t kLimit = std::int64_t{1} << 62;
  EXPECT_EQ(shift_rounded(kLimit, 62), 1);
  EXPECT_EQ(shift_rounded(-kLimit, 62), -1);
  EXPECT_EQ(shift_rounded(kLimit / 2, 62), 1);
  EXPECT_EQ(shift_rounded(-kLimit / 2, 62), -1);
  EXPECT_EQ(shift_rounded(kLimit / 2 - 1, 62), 0);
  EXPECT_EQ(shift_rounded(-kLimit / 2 + 1, 62), 0);
}

TEST(DivideRounded, RoundsToNearestAwayFromZero) {
  for (int numerator = -600; numerator <= 600; ++numerator) {
    for (int denominator = -300; denominator <= 300; ++denominator) {
      if (denominator == 0) continue;
      ASSERT_EQ(divide_rounded(numerator, denominator),
                std::lround(static_cast<double>(numerator) / denominator))
          << numerator << " / " << denominator;
    }
  }
}

TEST(DivideRounded, DefinesDivisionByZero) {
  EXPECT_EQ(divide_rounded(1, 0), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(divide_rounded(-1, 0), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(divide_rounded(0, 0), 0);
}

}  // namespace
}  // namespace koboshi::fixed
