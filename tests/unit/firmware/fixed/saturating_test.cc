#include "firmware/fixed/saturating.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace koboshi::fixed {
namespace {

template <typename T>
struct Range {
  static constexpr int kMin = std::numeric_limits<T>::min();
  static constexpr int kMax = std::numeric_limits<T>::max();
};

// Runs over all pairs of 8-bit numbers, or over pairs of 16-bit numbers of which one takes all values.
template <typename T, typename Check>
void for_pairs(Check check) {
  constexpr int kStep = sizeof(T) == 1 ? 1 : 509;  // a prime, so that all low bytes occur
  for (int a = Range<T>::kMin; a <= Range<T>::kMax; ++a) {
    for (int b = Range<T>::kMin; b <= Range<T>::kMax; b += kStep) check(a, b);
    check(a, Range<T>::kMax);
  }
}

template <typename T>
class Saturating : public testing::Test {};
using Types = testing::Types<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t>;
TYPED_TEST_SUITE(Saturating, Types);

TYPED_TEST(Saturating, AddsAndSubtracts) {
  using T = TypeParam;
  int wrong = 0;
  for_pairs<T>([&](int a, int b) {
    wrong += add_saturated(static_cast<T>(a), static_cast<T>(b)) !=
             std::clamp(a + b, Range<T>::kMin, Range<T>::kMax);
    wrong += subtract_saturated(static_cast<T>(a), static_cast<T>(b)) !=
             std::clamp(a - b, Range<T>::kMin, Range<T>::kMax);
  });
  EXPECT_EQ(wrong, 0);
}

TYPED_TEST(Saturating, HasAWrappingTwin) {
  using T = TypeParam;
  constexpr int kModulus = 1 << (8 * sizeof(T));
  const auto congruent = [](int a, int b) { return (a - b) % kModulus == 0; };
  int wrong = 0;
  for_pairs<T>([&](int a, int b) {
    wrong += !congruent(add_wrapped(static_cast<T>(a), static_cast<T>(b)), a + b);
    wrong += !congruent(subtract_wrapped(static_cast<T>(a), static_cast<T>(b)), a - b);
  });
  EXPECT_EQ(wrong, 0);
}

TYPED_TEST(Saturating, NarrowsFromWiderIntegers) {
  using T = TypeParam;
  for (int value = -70'000; value <= 70'000; ++value) {
    ASSERT_EQ(saturate<T>(value), std::clamp(value, Range<T>::kMin, Range<T>::kMax));
    ASSERT_EQ(saturate<T>(std::int64_t{value} << 20),
              std::clamp<std::int64_t>(std::int64_t{value} << 20, Range<T>::kMin, Range<T>::kMax));
    ASSERT_EQ((wrap<T>(value) - value) % (1 << (8 * sizeof(T))), 0);
  }
}

TEST(Saturate, HandlesTheSignOfItsArgument) {
  EXPECT_EQ(saturate<std::int32_t>(0xFFFFFFFFU), 0x7FFFFFFF);
  EXPECT_EQ(saturate<std::uint32_t>(-1), 0U);
  EXPECT_EQ(saturate<std::uint32_t>(std::int64_t{1} << 40), 0xFFFFFFFFU);
  EXPECT_EQ(saturate<std::int32_t>(std::numeric_limits<std::int64_t>::min()),
            std::numeric_limits<std::int32_t>::min());
}

}  // namespace
}  // namespace koboshi::fixed
