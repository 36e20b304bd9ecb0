#include "simulation/record/ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <random>
#include <thread>

namespace koboshi::simulation {
namespace {

bool put(Ring& ring, std::uint32_t kind, std::initializer_list<std::uint64_t> words) {
  const std::span<std::uint64_t> slot = ring.claim(kind, words.size());
  if (slot.empty()) return false;
  std::copy(words.begin(), words.end(), slot.begin());
  ring.publish();
  return true;
}

TEST(Ring, KeepsKindsAndWordsInOrder) {
  Ring ring(2048, WhenFull::kWait);
  put(ring, 7, {1, 2, 3});
  put(ring, 8, {4});
  ring.close();
  Ring::Record record;
  ASSERT_TRUE(ring.read(record));
  EXPECT_EQ(record.kind, 7u);
  EXPECT_TRUE(std::ranges::equal(record.words, std::vector<std::uint64_t>{1, 2, 3}));
  ring.release();
  ASSERT_TRUE(ring.read(record));
  EXPECT_EQ(record.kind, 8u);
  EXPECT_TRUE(std::ranges::equal(record.words, std::vector<std::uint64_t>{4}));
  ring.release();
  EXPECT_FALSE(ring.read(record));
}

// The consumer sleeps until a batch is full, unless it is told to hurry.
TEST(Ring, WakesTheConsumerForLessThanABatch) {
  Ring ring(2048, WhenFull::kWait);
  std::promise<std::uint64_t> first;
  std::thread consumer([&] {
    Ring::Record record;
    for (bool is_first = true; ring.read(record); is_first = false) {
      if (is_first) first.set_value(record.words[0]);
      ring.release();
    }
  });
  put(ring, 1, {42});
  ring.hurry();
  std::future<std::uint64_t> read = first.get_future();
  EXPECT_EQ(read.wait_for(std::chrono::seconds(60)), std::future_status::ready);
  ring.close();
  consumer.join();
  EXPECT_EQ(read.get(), 42u);
}

TEST(Ring, CountsWhatItDropsWhenFullInRealTime) {
  Ring ring(2048, WhenFull::kDrop);
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += put(ring, 1, {static_cast<std::uint64_t>(i), 0, 0}) ? 1 : 0;
  EXPECT_EQ(taken, 512);  // four words each
  EXPECT_EQ(ring.dropped(), 488u);
  ring.close();
  Ring::Record record;
  for (std::uint64_t i = 0; i < 512; ++i) {
    ASSERT_TRUE(ring.read(record));
    ASSERT_EQ(record.words[0], i) << "the oldest are kept";
    ring.release();
  }
  EXPECT_FALSE(ring.read(record));
}

// A small ring and many records of changing length, so that both threads wait for each other and the memory's
// end is met at every offset.
TEST(Ring, LosesNothingBetweenTwoThreadsWhenItWaits) {
  constexpr std::uint64_t kRecords = 200'000;
  Ring ring(2048, WhenFull::kWait);
  std::thread producer([&] {
    std::mt19937 random(5);
    for (std::uint64_t i = 0; i < kRecords; ++i) {
      const std::span<std::uint64_t> words = ring.claim(static_cast<std::uint32_t>(i % 3), 1 + random() % 60);
      std::ranges::fill(words, i);
      ring.publish();
    }
    ring.close();
  });
  std::mt19937 random(5);
  std::uint64_t count = 0;
  std::uint64_t wrong = 0;
  Ring::Record record;
  while (ring.read(record)) {
    if (record.kind != count % 3 || record.words.size() != 1 + random() % 60) ++wrong;
    for (const std::uint64_t word : record.words) wrong += word != count ? 1 : 0;
    ++count;
    ring.release();
  }
  producer.join();
  EXPECT_EQ(count, kRecords);
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(ring.dropped(), 0u);
}

}  // namespace
}  // namespace koboshi::simulation
