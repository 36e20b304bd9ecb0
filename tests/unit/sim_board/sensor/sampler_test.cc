#include "sim_board/sensor/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace koboshi::sim_board {
namespace {

TEST(Sampler, IsDueAtMultiplesOfItsPeriod) {
  Sampler sampler(1000, {0, 1, "imu"});
  sampler.start(2500);
  EXPECT_FALSE(sampler.due(2999));
  EXPECT_TRUE(sampler.due(3000));
  EXPECT_EQ(sampler.take().actual_us, 3000u);
  EXPECT_EQ(sampler.take().actual_us, 4000u);
}

TEST(Sampler, StartsWithTheFirstMultipleAfterATime) {
  Sampler sampler(300, {0, 1, "imu"});
  sampler.start(1000);
  EXPECT_EQ(sampler.take().actual_us, 1200u);
  sampler.start(1200);
  EXPECT_EQ(sampler.take().actual_us, 1500u);
}

TEST(Sampler, DisplacesInstantsUniformlyWithinItsJitter) {
  constexpr std::int64_t kJitter_us = 7;
  constexpr int kInstants = 30'000;
  Sampler sampler(1000, {kJitter_us, 5, "imu"});
  sampler.start(0);
  std::vector<int> bins(2 * kJitter_us + 1);
  double product = 0.0;
  std::int64_t last_us = 0;
  for (std::uint64_t i = 1; i <= kInstants; ++i) {
    const Sampler::Instant instant = sampler.take();
    ASSERT_EQ(instant.nominal_us, 1000 * i);
    const auto miss_us = static_cast<std::int64_t>(instant.actual_us - instant.nominal_us);
    ++bins.at(static_cast<std::size_t>(miss_us + kJitter_us));
    product += static_cast<double>(miss_us * last_us) / kInstants;
    last_us = miss_us;
  }
  double chi_squared = 0.0;
  const double expected = kInstants / static_cast<double>(bins.size());
  for (const int count : bins) chi_squared += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi_squared, 29.1);  // 14 degrees of freedom, 1 %
  EXPECT_GT(chi_squared, 4.66);  // and 99 %
  const double variance_us2 = (2 * kJitter_us + 1) * (2 * kJitter_us + 1) / 12.0 - 1.0 / 12.0;
  EXPECT_NEAR(product, 0.0, 4.0 * variance_us2 / std::sqrt(kInstants));  // each independent of the last
}

TEST(Sampler, KeepsItsOrderAtTheLargestJitter) {
  for (const std::uint64_t period_us : {1u, 2u, 3u, 100u}) {
    Sampler sampler(period_us, {Sampler::max_jitter_us(period_us), 3, "imu"});
    sampler.start(0);
    std::uint64_t last_us = 0;
    for (int i = 0; i < 10'000; ++i) {
      const std::uint64_t actual_us = sampler.take().actual_us;
      ASSERT_GT(actual_us, last_us) << period_us;
      last_us = actual_us;
    }
  }
}

TEST(Sampler, NeverSamplesBeforeItStarts) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Sampler sampler(1000, {400, seed, "imu"});
    sampler.start(999);
    EXPECT_FALSE(sampler.due(998));
    const Sampler::Instant first = sampler.take();
    EXPECT_EQ(first.nominal_us, 1000u);
    EXPECT_GE(first.actual_us, 999u);
  }
}

TEST(Sampler, RejectsPeriodsAndJitterThatWouldReorderSamples) {
  EXPECT_THROW(Sampler(0, {0, 1, "imu"}), std::invalid_argument);
  EXPECT_THROW(Sampler(1000, {500, 1, "imu"}), std::invalid_argument);
}

TEST(Delay, IsExactToTheMicrosecond) {
  Delay<int> delay(1234, 4);
  delay.push(42, 1000);
  int value = 0;
  EXPECT_FALSE(delay.poll(2233, value));
  EXPECT_EQ(value, 0);
  EXPECT_TRUE(delay.poll(2234, value));
  EXPECT_EQ(value, 42);
  EXPECT_FALSE(delay.poll(9999, value));
}

TEST(Delay, DeliversAtOnceWithZeroDelay) {
  Delay<int> delay(0, 1);
  delay.push(42, 1000);
  int value = 0;
  EXPECT_TRUE(delay.poll(1000, value));
}

TEST(Delay, KeepsOrderAndDropsTheOldestWhenFull) {
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
}  // namespace koboshi::sim_board
