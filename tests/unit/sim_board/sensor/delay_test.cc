#include "sim_board/sensor/delay.h"

#include <gtest/gtest.h>

#include "sim_board/sensor/sampler.h"

namespace koboshi::sim {
namespace {

TEST(Sampler, TicksAtMultiplesOfItsPeriod) {
  Sampler sampler(1000);
  EXPECT_FALSE(sampler.due(999));
  EXPECT_TRUE(sampler.due(1000));
  EXPECT_EQ(sampler.take(), 1000u);
  EXPECT_FALSE(sampler.due(1999));
  EXPECT_EQ(sampler.take(), 2000u);
}

TEST(Sampler, StartsWithTheFirstMultipleAfterATime) {
  Sampler sampler(300);
  sampler.start(1000);
  EXPECT_EQ(sampler.take(), 1200u);
  sampler.start(1200);
  EXPECT_EQ(sampler.take(), 1500u);
}

TEST(Sampler, RefusesAPeriodOfZero) { EXPECT_THROW(Sampler(0), std::invalid_argument); }

TEST(Delay, DeliversToTheMicrosecond) {
  Delay<int> delay(1234, 4);
  delay.push(42, 1000);
  int value = 0;
  EXPECT_FALSE(delay.poll(2233, value));
  EXPECT_EQ(value, 0);
  EXPECT_TRUE(delay.poll(2234, value));
  EXPECT_EQ(value, 42);
  EXPECT_FALSE(delay.poll(9999, value));
}

TEST(Delay, DeliversAtOnceWithoutDelay) {
  Delay<int> delay(0, 1);
  delay.push(42, 1000);
  int value = 0;
  EXPECT_TRUE(delay.poll(1000, value));
}

TEST(Delay, KeepsOrderAndLosesTheOldestWhenFull) {
  Delay<int> delay(10, 3);
  for (int i = 0; i < 5; ++i) delay.push(i, static_cast<std::uint64_t>(i));
  int value = -1;
  for (int expected = 2; expected < 5; ++expected) {
    ASSERT_TRUE(delay.poll(100, value));
    EXPECT_EQ(value, expected);
  }
  EXPECT_FALSE(delay.poll(100, value));
}

}  // namespace
}  // namespace koboshi::sim
