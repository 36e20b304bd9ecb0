#include "sim_board/sensor/channel.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace koboshi::sim_board {
namespace {

TEST(Saturation, PassesValuesInRangeAndLimitsOthers) {
  const Saturation saturation(4.0);
  EXPECT_EQ(saturation.apply(3.999), 3.999);
  EXPECT_EQ(saturation.apply(-4.0), -4.0);
  EXPECT_EQ(saturation.apply(4.001), 4.0);
  EXPECT_EQ(saturation.apply(-1e9), -4.0);
}

TEST(Saturation, RejectsANonPositiveRange) { EXPECT_THROW(Saturation(0.0), std::invalid_argument); }

TEST(Quantiser, RoundsToTheNearestCountOverAllSixteenBits) {
  constexpr double kResolution = 0.25;  // exact in binary, so that the halves below are exact ties
  const Quantiser quantiser(kResolution);
  for (int count = -32768; count <= 32767; ++count) {
    ASSERT_EQ(quantiser.convert(count * kResolution), count);
    ASSERT_EQ(quantiser.convert((count + 0.499) * kResolution), count);
    ASSERT_EQ(quantiser.convert((count - 0.499) * kResolution), count);
    const int even_above = count % 2 == 0 ? count : count + 1;
    ASSERT_EQ(quantiser.convert((count + 0.5) * kResolution), std::min(even_above, 32767));
  }
}

TEST(Quantiser, SaturatesAtBothEnds) {
  const Quantiser quantiser(0.001);
  EXPECT_EQ(quantiser.convert(32.768), 32767);
  EXPECT_EQ(quantiser.convert(1e12), 32767);
  EXPECT_EQ(quantiser.convert(-32.769), -32768);
  EXPECT_EQ(quantiser.convert(-1e12), -32768);
}

TEST(Quantiser, RejectsANonPositiveResolution) { EXPECT_THROW(Quantiser(0.0), std::invalid_argument); }

}  // namespace
}  // namespace koboshi::sim_board
