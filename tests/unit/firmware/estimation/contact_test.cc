#include "firmware/estimation/contact.h"

#include <gtest/gtest.h>

#include <limits>

#include "firmware/fixed/host/convert.h"
#include "firmware/fixed/literals.h"

namespace koboshi::estimation {
namespace {

using namespace fixed::literals;

constexpr fixed::Force kTouchdown_N = fixed::Force::from_raw(1 << 16);  // 1 N

FootPressure loaded(double load_N) {
  FootPressure foot;
  foot.load = fixed::from_double<fixed::Force>(load_N);
  foot.contact = load_N >= 1.0;
  return foot;
}

TEST(ContactWatch, LosesContactAtHalfTheLoadOfATouchdown) {
  ContactWatch watch(kTouchdown_N);
  EXPECT_FALSE(watch.update(loaded(0.99), 0).touches);
  EXPECT_TRUE(watch.update(loaded(1.01), 0).touches);
  EXPECT_TRUE(watch.update(loaded(0.51), 0).touches);
  EXPECT_FALSE(watch.update(loaded(0.49), 0).touches);
  EXPECT_FALSE(watch.update(loaded(0.99), 0).touches);
}

// From 0 to 4 N in 10 ms: the limit of 1 N was passed 7.5 ms before the last sample, which is 2 ms old.
TEST(ContactWatch, TellsTheMomentBetweenTwoSamples) {
  ContactWatch watch(kTouchdown_N);
  watch.update(loaded(0), 2'000);
  EXPECT_EQ(watch.update(loaded(4), 2'000).since_us, 9'500u);
  EXPECT_EQ(watch.update(loaded(4), 2'000).since_us, 19'500u);
  // From 4 to -1 N: that of 0.5 N, 3 ms before.
  EXPECT_EQ(watch.update(loaded(-1), 0).since_us, 3'000u);
}

TEST(ContactWatch, SaturatesItsTime) {
  ContactWatch watch(kTouchdown_N);
  watch.update(loaded(0), 0);
  EXPECT_EQ(watch.update(loaded(2), std::numeric_limits<std::uint32_t>::max()).since_us,
            std::numeric_limits<std::uint32_t>::max());
  EXPECT_EQ(watch.update(loaded(2), 0).since_us, std::numeric_limits<std::uint32_t>::max());
}

}  // namespace
}  // namespace koboshi::estimation
