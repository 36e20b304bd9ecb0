// Results that must be the same bits everywhere (tests/unit/firmware/fixed/digest.h).

#include <gtest/gtest.h>

#include <cstdint>

#include "firmware/fixed/trigonometry.h"
#include "tests/unit/firmware/fixed/digest.h"

namespace koboshi::fixed {
namespace {

constexpr std::int64_t kStep_raw = 4'001;  // a prime: the samples do not repeat the low bits

TEST(SameBits, OfSineAndCosine) {
  test::Digest digest;
  for (std::int64_t raw = -(std::int64_t{1} << 31); raw < std::int64_t{1} << 31; raw += kStep_raw) {
    const SineCosine both = sin_cos(Angle::from_raw(static_cast<std::int32_t>(raw)));
    digest.add(both.sine.raw());
    digest.add(both.cosine.raw());
  }
  EXPECT_EQ(digest.value(), 0xDD6B'AA40'7DCF'B8F6u);
}

// The segments of the arc tangent, by its ratio.
TEST(SameBits, OfArcTangents) {
  test::Digest digest;
  for (std::int32_t raw = -(1 << 30); raw <= (1 << 30) - kStep_raw; raw += kStep_raw) {
    digest.add(atan2(Ratio::from_raw(raw), kOne).raw());
    digest.add(asin(Ratio::from_raw(raw)).raw());
    digest.add(acos(Ratio::from_raw(raw)).raw());
  }
  EXPECT_EQ(digest.value(), 0x1BF7'2A8D'408C'0398u);
}

}  // namespace
}  // namespace koboshi::fixed
