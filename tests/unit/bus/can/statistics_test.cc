#include "bus/can/statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace koboshi::bus {
namespace {

TEST(Statistics, MeasurePeriodsAndTheDelayAfterSync) {
  BusStatistics statistics;
  for (std::uint64_t cycle = 0; cycle < 100; ++cycle) {
    const std::uint64_t sync_us = 10'000 * cycle + (cycle % 2) * 20;
    statistics.add({hal::CanFrame{.identifier = 0x080}, sync_us});
    statistics.add({hal::CanFrame{.identifier = 0x190, .size = 8}, sync_us + 300 + cycle});
  }
  EXPECT_EQ(statistics.frames(), 200u);
  const IdentifierStatistics& sync = statistics.identifiers().at(0x080);
  EXPECT_EQ(sync.frames, 100u);
  EXPECT_NEAR(sync.mean_period_us(), 10'000.0, 1.0);
  EXPECT_EQ(sync.shortest_us, 9'980u);
  EXPECT_EQ(sync.longest_us, 10'020u);
  const IdentifierStatistics& pdo = statistics.identifiers().at(0x190);
  EXPECT_EQ(pdo.earliest_after_sync_us, 300u);
  EXPECT_EQ(pdo.latest_after_sync_us, 399u);
}

// A frame without data takes 44 to 53 bits and 3 of intermission; here every 100 us.
TEST(Statistics, MeasureTheLoadOfABusOfOneMegabit) {
  BusStatistics statistics;
  for (std::uint64_t i = 0; i <= 1'000; ++i) statistics.add({hal::CanFrame{.identifier = 0x555}, 100 * i});
  EXPECT_GT(statistics.load(), 0.46);
  EXPECT_LT(statistics.load(), 0.57);
}

// 29-bit identifiers take time on the bus, but are no frames of a node.
TEST(Statistics, CountForeignFramesApart) {
  BusStatistics statistics;
  const sim_board::ForeignFrame extended{.extended = true, .identifier = 0x18FEF100};
  const sim_board::ForeignFrame error{
      .kind = sim_board::ForeignFrame::Kind::kError, .size = 8, .identifier = 4};
  for (std::uint64_t i = 0; i <= 1'000; ++i) statistics.add({extended, 100 * i});
  statistics.add({error, 100'000});
  statistics.add({hal::CanFrame{.identifier = 0x701, .remote = true}, 100'100});
  EXPECT_GT(statistics.load(), 0.66);  // 64 to 80 bits and 3 of intermission
  EXPECT_LT(statistics.load(), 0.84);
  EXPECT_EQ(statistics.frames(), 1'003u);
  EXPECT_TRUE(statistics.identifiers().empty());
  EXPECT_EQ(statistics.foreign().text(), "1001 with 29-bit identifiers, 1 error frame, 1 remote frame");
}

// Two frames a microsecond apart are not of one bus of 1 Mbit/s.
TEST(Statistics, SayThatALoadIsImpossible) {
  BusStatistics statistics;
  statistics.add({hal::CanFrame{.identifier = 0x181, .size = 8}, 0});
  statistics.add({hal::CanFrame{.identifier = 0x181, .size = 8}, 1});
  EXPECT_THAT(statistics_table(statistics), testing::HasSubstr("load above 100 %"));
}

TEST(Statistics, PrintATableWithoutFrames) {
  EXPECT_THAT(statistics_table({}), testing::HasSubstr("0 frames"));
  BusStatistics one;
  one.add({hal::CanFrame{.identifier = 0x701}, 5});
  EXPECT_THAT(statistics_table(one), testing::HasSubstr("701 heartbeat"));
}

}  // namespace
}  // namespace koboshi::bus
