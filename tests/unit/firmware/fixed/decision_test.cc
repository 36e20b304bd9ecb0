#include <gtest/gtest.h>

#include "firmware/fixed/dead_band.h"
#include "firmware/fixed/debounce.h"
#include "firmware/fixed/units.h"

namespace koboshi::fixed {
namespace {

constexpr Length raw(std::int32_t value) { return Length::from_raw(value); }

TEST(DeadBand, SubtractsItsHalfWidthOutside) {
  for (std::int32_t value = -20; value <= 20; ++value) {
    const std::int32_t expected = value > 7 ? value - 7 : value < -7 ? value + 7 : 0;
    EXPECT_EQ(dead_band(raw(value), raw(7)).raw(), expected) << value;
    EXPECT_EQ(dead_band(raw(value), Length()).raw(), value);
  }
  EXPECT_EQ(dead_band(Length::max(), raw(1)), raw(Length::max().raw() - 1));
  EXPECT_EQ(dead_band(Length::min(), raw(1)), raw(Length::min().raw() + 1));
}

TEST(Debounce, WaitsForAsManyConsecutiveSamplesAsRequired) {
  Debounce debounce;
  EXPECT_FALSE(debounce.update(true, 3));
  EXPECT_FALSE(debounce.update(true, 3));
  EXPECT_FALSE(debounce.update(false, 3));  // the count restarts
  EXPECT_FALSE(debounce.update(true, 3));
  EXPECT_FALSE(debounce.update(true, 3));
  EXPECT_TRUE(debounce.update(true, 3));
  EXPECT_TRUE(debounce.update(true, 3));
  EXPECT_FALSE(debounce.update(true, 9));  // the required count may change
  debounce.reset();
  EXPECT_FALSE(debounce.reached(1));
  EXPECT_TRUE(debounce.update(true, 1));
}

TEST(Debounce, TakesOneSampleWhenNoneIsRequired) {
  Debounce debounce;
  EXPECT_FALSE(debounce.update(false, 0));
  EXPECT_TRUE(debounce.update(true, 0));
}

TEST(Debounce, SaturatesItsCount) {
  Debounce debounce;
  for (int i = 0; i < 0x1'0000; ++i) debounce.count(true);
  EXPECT_TRUE(debounce.reached(0xFFFF));
}

}  // namespace
}  // namespace koboshi::fixed
