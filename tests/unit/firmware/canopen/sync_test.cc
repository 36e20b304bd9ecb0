#include "firmware/canopen/sync.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

TEST(Sync, CountsFromOneToItsOverflow) {
  Sync sync;
  sync.load_defaults(true, 0);
  ASSERT_EQ(sync.write(0x1019, 3), AbortCode::kNone);
  sync.start(0);
  for (const unsigned counter : {1u, 2u, 3u, 1u}) EXPECT_EQ(sync.next(), can_frame(0x080, {counter}));
  sync.start(0);
  EXPECT_EQ(sync.next(), can_frame(0x080, {1}));
}

TEST(Sync, AcceptsOverflowsOnlyWithoutAPeriod) {
  for (unsigned overflow = 0; overflow <= 255; ++overflow) {
    Sync sync;
    const bool allowed = overflow == 0 || (overflow >= 2 && overflow <= 240);
    EXPECT_EQ(sync.write(0x1019, overflow), allowed ? AbortCode::kNone : AbortCode::kInvalidValue);
    ASSERT_EQ(sync.write(0x1006, 10'000), AbortCode::kNone);
    EXPECT_EQ(sync.write(0x1019, overflow), AbortCode::kDeviceState);
  }
}

TEST(Sync, RestartsItsCounterWhenItBecomesTheProducer) {
  Sync sync;
  sync.load_defaults(true, 0);
  ASSERT_EQ(sync.write(0x1019, 3), AbortCode::kNone);
  static_cast<void>(sync.next());
  ASSERT_EQ(sync.write(0x1005, 0x080), AbortCode::kNone);
  ASSERT_EQ(sync.write(0x1005, 0x4000'0080), AbortCode::kNone);
  EXPECT_EQ(sync.next(), can_frame(0x080, {1}));
}

TEST(Sync, BeginsANewPeriodAtOnce) {
  for (const std::uint64_t begin_us : {std::uint64_t{0}, std::uint64_t{3'000}}) {
    Sync sync;
    sync.load_defaults(true, 0);
    ASSERT_EQ(sync.write(0x1006, 10'000), AbortCode::kNone);
    EXPECT_TRUE(sync.take_due(begin_us));
    EXPECT_FALSE(sync.take_due(begin_us));
    EXPECT_TRUE(sync.take_due(begin_us + 13'000));
  }
}

TEST(NodeSync, RestartsItsCounterAfterStopped) {
  NodeDescription description = kTestDescription;
  description.sync_producer = true;
  TestNode device(0x10, description);
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1019, 0}, 10, 1), AbortCode::kNone);
  device.node.send_sync(0);
  device.node.send_sync(0);
  device.node.command(NmtCommand::kEnterPreOperational, 0);
  device.sink.frames.clear();
  device.node.send_sync(0);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x080, {3})});
  device.node.command(NmtCommand::kStop, 0);
  device.node.command(NmtCommand::kEnterPreOperational, 0);
  device.node.send_sync(0);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x080, {1})});
}

// A SYNC producer whose owner triggers it every 10 ms, as in the controller.
class NodeSyncByOwner : public testing::Test {
 protected:
  NodeSyncByOwner() : device(0x10, description()) { device.make_operational(); }

  static const NodeDescription& description() {
    static const NodeDescription description = [] {
      NodeDescription producer = kTestDescription;
      producer.sync_producer = true;
      producer.sync_period_us = 10'000;
      producer.sync_by_owner = true;
      return producer;
    }();
    return description;
  }
  // Returns the number of SYNCs in ten of the owner's cycles.
  std::ptrdiff_t syncs() {
    device.sink.frames.clear();
    for (int i = 0; i < 10; ++i, now_us += 10'000) {
      device.node.process(now_us);
      device.node.send_sync(now_us);
    }
    return std::ranges::count(device.sink.frames, kSyncCobId, &hal::CanFrame::identifier);
  }
  AbortCode write(std::uint16_t index, std::uint32_t value) {
    return device.node.write_object({index, 0}, value, index == 0x1019 ? 1 : 4);
  }

  TestNode device;
  std::uint64_t now_us = 0;
};

TEST_F(NodeSyncByOwner, SendsOneInEachCycle) { EXPECT_EQ(syncs(), 10); }

TEST_F(NodeSyncByOwner, IsOffWithoutBit30) {
  ASSERT_EQ(write(0x1005, 0x080), AbortCode::kNone);
  EXPECT_EQ(syncs(), 0);
  ASSERT_EQ(write(0x1005, 0x4000'0080), AbortCode::kNone);
  EXPECT_EQ(syncs(), 10);
}

TEST_F(NodeSyncByOwner, AcceptsOnlyItsPeriodAndZero) {
  ObjectValue period;
  ASSERT_EQ(device.node.read_object({0x1006, 0}, period), AbortCode::kNone);
  EXPECT_EQ(period.number(), 10'000u);
  for (const std::uint32_t other : {1u, 5'000u, 9'999u, 20'000u, 0xFFFF'FFFFu}) {
    EXPECT_EQ(write(0x1006, other), AbortCode::kInvalidValue);
  }
  EXPECT_EQ(syncs(), 10);
  ASSERT_EQ(write(0x1006, 0), AbortCode::kNone);
  EXPECT_EQ(syncs(), 0);
  ASSERT_EQ(write(0x1006, 10'000), AbortCode::kNone);
  EXPECT_EQ(syncs(), 10);
}

TEST_F(NodeSyncByOwner, AcceptsACounterOnlyWithoutAPeriod) {
  EXPECT_EQ(write(0x1019, 10), AbortCode::kDeviceState);
  ASSERT_EQ(write(0x1006, 0), AbortCode::kNone);
  ASSERT_EQ(write(0x1019, 10), AbortCode::kNone);
  ASSERT_EQ(write(0x1006, 10'000), AbortCode::kNone);
  syncs();
  EXPECT_EQ(device.sink.frames.front(), can_frame(0x080, {1}));
}

TEST(NodeSync, OfUnexpectedLengthIsIgnoredAndReported) {
  for (const unsigned overflow : {0u, 10u}) {
    TestNode device;
    device.make_operational();
    ASSERT_EQ(device.node.write_object({0x1019, 0}, overflow, 1), AbortCode::kNone);
    const auto wrong = overflow == 0 ? can_frame(0x080, {1}) : can_frame(0x080, {});
    const auto right = overflow == 0 ? can_frame(0x080, {}) : can_frame(0x080, {1});
    EXPECT_EQ(device.ask(wrong),
              std::vector{can_frame(0x090, {0x40, 0x82, 0x11, overflow == 0 ? 1u : 0u, 0, 0, 0, 0})});
    EXPECT_TRUE(device.ask(wrong).empty());
    EXPECT_EQ(device.syncs, 0);
    const auto answers = device.ask(right);
    ASSERT_EQ(answers.size(), 2u);
    EXPECT_EQ(answers[0], can_frame(0x090, {0, 0, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(answers[1].identifier, 0x190);
  }
}

TEST(NodeSync, StartValueSelectsTheFirstSyncOfATpdo) {
  TestNode device;
  device.node.start(0);
  ASSERT_EQ(device.node.write_object({0x1019, 0}, 10, 1), AbortCode::kNone);
  EXPECT_EQ(device.node.write_object({0x1800, 6}, 3, 1), AbortCode::kInvalidValue);  // while the PDO is valid
  ASSERT_EQ(device.node.write_object({0x1800, 1}, 0xC000'0190, 4), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1800, 2}, 2, 1), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1800, 6}, 3, 1), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1800, 1}, 0x4000'0190, 4), AbortCode::kNone);
  device.node.command(NmtCommand::kStart, 0);
  std::string answered;
  for (const unsigned counter : {1u, 2u, 3u, 4u, 5u, 6u, 7u}) {
    answered += device.ask(can_frame(0x080, {counter})).empty() ? '.' : 'x';
  }
  EXPECT_EQ(answered, "...x.x.");
  // Operational again, it waits for the start value again.
  device.node.command(NmtCommand::kEnterPreOperational, 0);
  device.node.command(NmtCommand::kStart, 0);
  answered.clear();
  for (const unsigned counter : {8u, 9u, 10u, 1u, 2u, 3u, 4u}) {
    answered += device.ask(can_frame(0x080, {counter})).empty() ? '.' : 'x';
  }
  EXPECT_EQ(answered, "......x");
}

TEST(NodeSync, WindowDiscardsLateData) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1007, 0}, 1'000, 4), AbortCode::kNone);
  device.node.on_frame(can_frame(0x080, {}), 10'000);
  device.node.on_frame(can_frame(0x210, {1, 0, 0, 0, 0, 0}), 11'000);
  device.node.on_frame(can_frame(0x210, {2, 0, 0, 0, 0, 0}), 11'001);
  device.node.on_frame(can_frame(0x080, {}), 20'000);
  EXPECT_EQ(device.values.controlword, 1);
}

}  // namespace
}  // namespace koboshi::canopen
