#include "firmware/fixed/literals.h"

#include <gtest/gtest.h>

namespace koboshi::fixed {
namespace {

using namespace literals;

TEST(Literals, AreTheNearestFixedPointNumber) {
  EXPECT_EQ((90.0_deg).raw(), 1 << 30);
  EXPECT_EQ((0.1_deg).raw(), 1'193'046);    // 2^32 / 3600 = 1193046.47
  EXPECT_EQ((1.0_rad).raw(), 683'565'276);  // 2^32 / (2 pi) = 683565275.58
  EXPECT_EQ((360.0_deg_per_s).raw(), 1 << 24);
  EXPECT_EQ((1.0_rad_per_s).raw(), 2'670'177);  // 2^24 / (2 pi) = 2670176.85
  EXPECT_EQ((0.065_m).raw(), 1'090'519);        // 0.065 2^24 = 1090519.04
  EXPECT_EQ((1.373_Nm).raw(), 1'439'695);       // 1.373 2^20 = 1439694.85
  EXPECT_EQ((0.5_N).raw(), 1 << 15);
  EXPECT_EQ((9.80665_m_per_s2).raw(), 10'283'018);  // 9.80665 2^20 = 10283017.83
  EXPECT_EQ((1.2_kg).raw(), 20'132'659);            // 1.2 2^24 = 20132659.2
  EXPECT_EQ((0.05_gain).raw(), 3277);               // 0.05 2^16 = 3276.8
  EXPECT_EQ((0.5_ratio).raw(), 1 << 29);
}

TEST(Literals, ReachTheLimitsOfTheirQuantity) {
  EXPECT_EQ((179.9999999_deg).raw(), 0x7FFFFFFF);  // 1e-7 degrees are 1.2 LSB
  EXPECT_EQ((127.99999997_m).raw(), 0x7FFFFFFF);
  EXPECT_EQ(-127.99999997_m, Length::min() + Length::from_raw(1));
}

}  // namespace
}  // namespace koboshi::fixed
