#include "tools/teleop/sliding_rate.h"

#include <gtest/gtest.h>

namespace koboshi::tools {
namespace {

TEST(SlidingRate, IsZeroInitially) {
  SlidingRate<1> rate(1.0);
  EXPECT_EQ(rate.per_s()[0], 0.0);
  rate.add(3.0, {7.0});
  EXPECT_EQ(rate.per_s()[0], 0.0);
  rate.add(3.0, {8.0});
  EXPECT_EQ(rate.per_s()[0], 0.0);
}

TEST(SlidingRate, IsTheMeanOfAvailableValues) {
  SlidingRate<2> rate(1.0);
  rate.add(0.0, {0.0, 1.0});
  rate.add(0.5, {1.0, 0.0});
  EXPECT_DOUBLE_EQ(rate.per_s()[0], 2.0);
  EXPECT_DOUBLE_EQ(rate.per_s()[1], -2.0);
}

TEST(SlidingRate, DropsValuesOlderThanTheWindow) {
  SlidingRate<1> rate(1.0);
  for (int i = 0; i <= 40; ++i) rate.add(0.125 * i, {i < 20 ? 100.0 * i : 2000.0 + i});
  EXPECT_DOUBLE_EQ(rate.per_s()[0], 8.0);
}

}  // namespace
}  // namespace koboshi::tools
