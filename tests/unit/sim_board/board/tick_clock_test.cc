#include "sim_board/board/tick_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace koboshi::sim_board {
namespace {

constexpr std::uint64_t kPeriod_us = 10'000;
constexpr std::uint64_t kServicePeriod_us = 1'000;

// The times at which the ticks begin.
std::vector<std::uint64_t> ticks_us(TickClock clock, std::uint64_t duration_us) {
  std::vector<std::uint64_t> ticks;
  for (std::uint64_t now_us = 0; now_us < duration_us; now_us += kServicePeriod_us) {
    if (clock.due(now_us)) ticks.push_back(now_us + clock.late_us());
  }
  return ticks;
}

TEST(TickClock, KeepsItsPeriodWithoutJitter) {
  const auto ticks = ticks_us({kPeriod_us, kServicePeriod_us, 0, 1}, 1'000'000);
  ASSERT_EQ(ticks.size(), 100u);
  for (std::size_t i = 0; i < ticks.size(); ++i) EXPECT_EQ(ticks[i], i * kPeriod_us);
}

TEST(TickClock, DelaysEachTickByUpToItsJitterWithoutAddingUp) {
  constexpr std::uint64_t kJitter_us = 2'500;
  const auto ticks = ticks_us({kPeriod_us, kServicePeriod_us, kJitter_us, 1}, 20'000'000);
  ASSERT_EQ(ticks.size(), 2000u) << "one in each period";
  std::vector<std::uint64_t> delays_us;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ASSERT_GE(ticks[i], i * kPeriod_us);
    delays_us.push_back(ticks[i] - i * kPeriod_us);
  }
  EXPECT_LE(std::ranges::max(delays_us), kJitter_us);
  EXPECT_GT(std::ranges::max(delays_us), kJitter_us - 20);
  EXPECT_LT(std::ranges::min(delays_us), 20u);
  double mean_us = 0.0;
  for (const std::uint64_t delay_us : delays_us) mean_us += static_cast<double>(delay_us) / 2000.0;
  EXPECT_NEAR(mean_us, 0.5 * kJitter_us, 80.0);
}

TEST(TickClock, DependsOnItsSeed) {
  const auto first = ticks_us({kPeriod_us, kServicePeriod_us, 1'000, 1}, 1'000'000);
  EXPECT_EQ(first, ticks_us({kPeriod_us, kServicePeriod_us, 1'000, 1}, 1'000'000));
  EXPECT_NE(first, ticks_us({kPeriod_us, kServicePeriod_us, 1'000, 2}, 1'000'000));
}

}  // namespace
}  // namespace koboshi::sim_board
