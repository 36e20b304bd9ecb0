#include "sim_board/sensor/delay.h"

#include <gtest/gtest.h>

namespace koboshi::sim {
namespace {

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
