#include "firmware/fixed/radians.h"

#include <gtest/gtest.h>

#include "firmware/fixed/host/convert.h"

namespace koboshi::fixed {
namespace {

TEST(Radians, AreExactInBothFormatsAndBack) {
  for (double rad = -1.99; rad < 2.0; rad += 0.0037) {
    const auto angle = from_double<Angle>(rad);
    EXPECT_NEAR(to_double(in_rad(angle)), rad, 3e-9);
    EXPECT_NEAR(to_double(from_rad(from_double<Ratio>(rad))), rad, 3e-9);
  }
}

}  // namespace
}  // namespace koboshi::fixed
