#include "view/live/send_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/unit/view/live/batch_reader.h"

namespace koboshi::view {
namespace {

// A batch of one sample, one frame and, every tenth time, an event.
std::shared_ptr<const Batch> batch_at(std::uint64_t time_us) {
  BatchMaker maker(1, 0);
  maker.add_sample(time_us, std::vector<Pose>(1), {}, {});
  maker.add_frame({time_us, {.identifier = 0x80}});
  if (time_us % 10 == 0) maker.add_event({time_us, "state", "event " + std::to_string(time_us)});
  return std::make_shared<const Batch>(maker.take());
}

TEST(SendQueue, GivesEverythingToAPageThatKeepsUp) {
  SendQueue queue(3);
  EXPECT_TRUE(queue.empty());
  queue.push(batch_at(1));
  queue.push(batch_at(2));
  const auto read = read_batches(queue.take());
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].times_us, std::vector{1.0});
  EXPECT_EQ(read[1].times_us, std::vector{2.0});
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.take().empty());
}

// The newest samples arrive, the events all, and the number of what was left out.
TEST(SendQueue, DropsTheOldestSamplesOfASlowPageButNoEvent) {
  SendQueue queue(3);
  for (std::uint64_t time_us = 1; time_us <= 100; ++time_us) queue.push(batch_at(time_us));
  std::vector<std::string> events;
  std::vector<double> times_us;
  nlohmann::json lost;
  for (const ReadBatch& batch : read_batches(queue.take())) {
    times_us.insert(times_us.end(), batch.times_us.begin(), batch.times_us.end());
    if (batch.json.is_null()) continue;
    if (batch.json.contains("lost")) lost = batch.json["lost"];
    if (batch.json.contains("events")) events.push_back(batch.json["events"][0]["text"]);
  }
  EXPECT_EQ(times_us, (std::vector<double>{98, 99, 100}));
  EXPECT_EQ(lost, (nlohmann::json{{"samples", 97}, {"frames", 97}}));
  ASSERT_EQ(events.size(), 10u);
  EXPECT_EQ(events.front(), "event 10");
  EXPECT_EQ(events.back(), "event 100");
  // The count starts again.
  queue.push(batch_at(101));
  EXPECT_EQ(read_batches(queue.take()).size(), 1u);
}

}  // namespace
}  // namespace koboshi::view
