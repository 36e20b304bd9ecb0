#include "hal/stm32/interrupt_ring.h"

#include <gtest/gtest.h>

#include <thread>

namespace koboshi::hal::stm32 {
namespace {

TEST(InterruptRing, IsFirstInFirstOutAndBounded) {
  InterruptRing<int, 4> ring;
  int item = -1;
  EXPECT_FALSE(ring.pop(item));
  EXPECT_EQ(item, -1);
  for (int turn = 0; turn < 3; ++turn) {  // wraps round several times
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(10 * turn + i));
    EXPECT_FALSE(ring.push(99));
    EXPECT_EQ(ring.size(), 4u);
    for (int i = 0; i < 4; ++i) {
      ASSERT_TRUE(ring.pop(item));
      EXPECT_EQ(item, 10 * turn + i);
    }
    EXPECT_EQ(ring.size(), 0u);
  }
}

// Two threads are a harder case than an interrupt on one core.
TEST(InterruptRing, LosesNothingBetweenTwoThreads) {
  constexpr int kItems = 20'000;
  InterruptRing<int, 256> ring;
  std::thread producer([&ring] {
    for (int i = 0; i < kItems;) {
      if (ring.push(i)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  int errors = 0;
  for (int expected = 0; expected < kItems;) {
    int item = -1;
    if (!ring.pop(item)) {
      std::this_thread::yield();
    } else if (item != expected++) {
      ++errors;
    }
  }
  producer.join();
  EXPECT_EQ(errors, 0);
}

}  // namespace
}  // namespace koboshi::hal::stm32
