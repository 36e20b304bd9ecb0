#include "firmware/canopen/node/device_services.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

// 12:34:56.789 on 2 January 1984: 45 296 789 ms are 02B32C95h.
const hal::CanFrame kTime = can_frame(0x100, {0x95, 0x2C, 0xB3, 0x02, 0x01, 0x00});
constexpr TimeOfDay kTold{45'296'789, 1};

TEST(TimeStamp, SetsTheTimeOfDay) {
  TimeStamp time;
  EXPECT_FALSE(time.at(5).has_value());
  ASSERT_TRUE(time.identifies(kTime));
  ASSERT_TRUE(time.accept(kTime, 1'000));
  EXPECT_EQ(time.at(1'999), kTold);
}

TEST(TimeStamp, AdvancesByTheClockOfTheNode) {
  TimeStamp time;
  ASSERT_TRUE(time.accept(kTime, 1'000));
  EXPECT_EQ(time.at(1'000 + 500'000), (TimeOfDay{kTold.ms + 500, 1}));
  const std::uint64_t to_midnight_us = (kMillisecondsPerDay - kTold.ms) * std::uint64_t{1000};
  EXPECT_EQ(time.at(1'000 + to_midnight_us), (TimeOfDay{0, 2}));
}

TEST(TimeStamp, IgnoresReservedBitsAndRejectsInvalidTimes) {
  TimeStamp time;
  EXPECT_FALSE(time.accept(can_frame(0x100, {0x95, 0x2C, 0xB3, 0x02, 0x01}), 0));
  EXPECT_FALSE(time.accept(can_frame(0x100, {0x00, 0x5C, 0x26, 0x05, 0x01, 0x00}), 0));  // 86 400 000 ms
  EXPECT_FALSE(time.at(0).has_value());
  EXPECT_TRUE(time.accept(can_frame(0x100, {0x95, 0x2C, 0xB3, 0xF2, 0x01, 0x00}), 0));
  EXPECT_EQ(time.at(0), kTold);
}

TEST(TimeStamp, DoesNotChangeItsIdentifierWhileInUse) {
  TimeStamp time;
  EXPECT_EQ(time.cob_id(), 0x8000'0100u);
  EXPECT_EQ(time.write_cob_id(0x8000'0110), AbortCode::kInvalidValue);
  EXPECT_EQ(time.write_cob_id(0xC000'0100), AbortCode::kInvalidValue);  // producer bit
  EXPECT_EQ(time.write_cob_id(0xA000'0100), AbortCode::kInvalidValue);  // 29-bit identifier
  EXPECT_EQ(time.write_cob_id(0x0000'0100), AbortCode::kNone);
  EXPECT_FALSE(time.identifies(kTime));
  EXPECT_EQ(time.write_cob_id(0x8000'0000), AbortCode::kInvalidValue);  // NMT's identifier
  EXPECT_EQ(time.write_cob_id(0x8000'0090), AbortCode::kNone);
  EXPECT_TRUE(time.identifies(can_frame(0x090, {})));
}

TEST(NodeTime, IsReceivedInPreOperationalAndOperational) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.hear(kTime, 10);
  EXPECT_EQ(owner.times, std::vector{kTold});
  EXPECT_EQ(owner.services.time_of_day(10), kTold);
  owner.node.command(NmtCommand::kStart, 20);
  owner.hear(kTime, 30);
  owner.node.command(NmtCommand::kStop, 40);
  owner.hear(kTime, 50);
  EXPECT_EQ(owner.times.size(), 2u);
}

// A remote frame has a size, but no data.
TEST(NodeTime, IgnoresRemoteFrames) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.hear(kTime, 10);
  hal::CanFrame remote = can_frame(0x100, {0, 0, 0, 0, 0, 0});
  remote.remote = true;
  owner.hear(remote, 10);
  EXPECT_EQ(owner.times.size(), 1u);
  EXPECT_EQ(owner.services.time_of_day(10), kTold);
}

TEST(NodeTime, HasItsObject) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  ObjectValue value;
  ASSERT_EQ(owner.node.read_object({0x1012, 0}, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0x8000'0100u);
  EXPECT_EQ(owner.node.write_object({0x1012, 0}, 0, 4), AbortCode::kNone);
  owner.hear(kTime, 10);
  EXPECT_TRUE(owner.times.empty());
  EXPECT_EQ(owner.node.read_object({0x1012, 1}, value), AbortCode::kSubindexDoesNotExist);
}

}  // namespace
}  // namespace koboshi::canopen
