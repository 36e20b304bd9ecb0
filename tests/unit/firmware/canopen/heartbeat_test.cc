#include "firmware/canopen/heartbeat.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

using enum HeartbeatEventKind;

class HeartbeatMonitorTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(monitor_.write(1, (0x10u << 16) | 100), AbortCode::kNone); }

  std::vector<HeartbeatEvent> hear(NmtState state, std::uint64_t now_us, std::uint8_t node_id = 0x10) {
    HeartbeatEvent event;
    if (!monitor_.on_heartbeat({node_id, state}, now_us, event)) return {};
    return {event};
  }
  std::vector<HeartbeatEvent> check(std::uint64_t now_us) {
    std::vector<HeartbeatEvent> events;
    HeartbeatEvent event;
    while (monitor_.check(now_us, event)) events.push_back(event);
    return events;
  }
  static std::vector<HeartbeatEvent> one(HeartbeatEventKind kind, NmtState state) {
    return {{0x10, kind, state}};
  }

  std::array<HeartbeatConsumer, 3> consumers_;
  std::array<SlotMap::Item, 3> slots_;
  HeartbeatMonitor monitor_{consumers_, slots_};
};

TEST_F(HeartbeatMonitorTest, LosesANodeExactlyAfterItsTime) {
  EXPECT_EQ(hear(NmtState::kOperational, 1'000), one(kFirstSeen, NmtState::kOperational));
  EXPECT_TRUE(check(100'999).empty());
  EXPECT_EQ(check(101'000), one(kLost, NmtState::kOperational));
  EXPECT_TRUE(check(200'000).empty());
}

TEST_F(HeartbeatMonitorTest, EachHeartbeatRestartsTheTime) {
  std::uint64_t now_us = 0;
  hear(NmtState::kOperational, now_us);
  for (int i = 0; i < 10; ++i) {
    now_us += 99'000;
    EXPECT_TRUE(check(now_us).empty());
    EXPECT_TRUE(hear(NmtState::kOperational, now_us).empty());
  }
  EXPECT_FALSE(check(now_us + 100'000).empty());
}

TEST_F(HeartbeatMonitorTest, NeverLosesANodeThatWasNeverHeardOf) {
  EXPECT_TRUE(check(1'000'000'000).empty());
}

TEST_F(HeartbeatMonitorTest, ReportsChangesOfState) {
  hear(NmtState::kPreOperational, 0);
  EXPECT_TRUE(hear(NmtState::kPreOperational, 1'000).empty());
  EXPECT_EQ(hear(NmtState::kOperational, 2'000), one(kStateChanged, NmtState::kOperational));
  EXPECT_EQ(hear(NmtState::kStopped, 3'000), one(kStateChanged, NmtState::kStopped));
}

TEST_F(HeartbeatMonitorTest, ReportsTheReturnOfALostNode) {
  hear(NmtState::kOperational, 0);
  check(100'000);
  EXPECT_EQ(hear(NmtState::kOperational, 150'000), one(kFirstSeen, NmtState::kOperational));
}

TEST_F(HeartbeatMonitorTest, LosesANodeThatIsSilentAfterItsBootUp) {
  hear(NmtState::kOperational, 0);
  EXPECT_EQ(hear(NmtState::kInitialising, 50'000), one(kBootedUp, NmtState::kInitialising));
  EXPECT_TRUE(check(149'999).empty());
  EXPECT_EQ(check(150'000), one(kLost, NmtState::kInitialising));
  EXPECT_EQ(hear(NmtState::kPreOperational, 600'000), one(kFirstSeen, NmtState::kPreOperational));
}

TEST_F(HeartbeatMonitorTest, ContinuesWithANodeThatSpeaksAfterItsBootUp) {
  hear(NmtState::kOperational, 0);
  hear(NmtState::kInitialising, 50'000);
  EXPECT_EQ(hear(NmtState::kPreOperational, 100'000), one(kFirstSeen, NmtState::kPreOperational));
  EXPECT_TRUE(check(199'999).empty());
  EXPECT_EQ(check(200'000), one(kLost, NmtState::kPreOperational));
}

// The master may have to configure the heartbeat first.
TEST_F(HeartbeatMonitorTest, ABootUpAloneDoesNotStartMonitoring) {
  EXPECT_EQ(hear(NmtState::kInitialising, 0), one(kBootedUp, NmtState::kInitialising));
  EXPECT_TRUE(check(500'000).empty());
  hear(NmtState::kOperational, 600'000);
  ASSERT_EQ(check(700'000).size(), 1u);
  hear(NmtState::kInitialising, 800'000);
  EXPECT_TRUE(check(1'000'000).empty());
}

TEST_F(HeartbeatMonitorTest, DoesNotTimeOutForAnAwaitedNode) {
  hear(NmtState::kOperational, 0);
  monitor_.await(0x10);
  monitor_.await(0x11);  // not monitored
  EXPECT_TRUE(check(500'000).empty());
  hear(NmtState::kOperational, 600'000);
  EXPECT_EQ(check(700'000).size(), 1u);
}

TEST_F(HeartbeatMonitorTest, WritingTheConsumerEndsMonitoring) {
  hear(NmtState::kOperational, 0);
  ASSERT_EQ(monitor_.write(1, (0x10u << 16) | 100), AbortCode::kNone);
  EXPECT_TRUE(check(500'000).empty());
}

TEST_F(HeartbeatMonitorTest, IgnoresNodesItDoesNotMonitor) {
  EXPECT_TRUE(hear(NmtState::kOperational, 0, 0x11).empty());
  EXPECT_EQ(monitor_.find(0x11), nullptr);
  ASSERT_NE(monitor_.find(0x10), nullptr);
  EXPECT_FALSE(monitor_.find(0x10)->alive);
}

TEST_F(HeartbeatMonitorTest, Object1016ReadsAndWritesItsConsumers) {
  ObjectValue value;
  ASSERT_EQ(monitor_.read(0, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 3u);
  ASSERT_EQ(monitor_.read(1, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0x00100064u);
  EXPECT_EQ(monitor_.read(4, value), AbortCode::kSubindexDoesNotExist);
  EXPECT_EQ(monitor_.write(4, 0), AbortCode::kSubindexDoesNotExist);
  EXPECT_EQ(monitor_.write(0, 0), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(monitor_.write(2, 0x00800064), AbortCode::kInvalidValue);
  EXPECT_EQ(monitor_.write(2, (0x10u << 16) | 50), AbortCode::kParameterIncompatibility);
  EXPECT_EQ(monitor_.write(1, (0x10u << 16) | 50), AbortCode::kNone);
  EXPECT_EQ(monitor_.write(1, 0), AbortCode::kNone);
  EXPECT_EQ(monitor_.find(0x10), nullptr);
}

TEST_F(HeartbeatMonitorTest, ClearRemovesAllConsumers) {
  hear(NmtState::kOperational, 0);
  monitor_.clear();
  EXPECT_EQ(monitor_.find(0x10), nullptr);
  EXPECT_TRUE(hear(NmtState::kStopped, 0).empty());
  EXPECT_TRUE(check(1'000'000).empty());
}

TEST(NodeHeartbeat, ReportsFromTheBusToTheOwner) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1016, 1}, (0x01u << 16) | 20, 4), AbortCode::kNone);
  device.node.on_frame(can_frame(0x701, {0x05}), 1'000);
  device.node.process(20'000);
  device.node.process(21'000);
  EXPECT_EQ(device.heartbeats, (std::vector<HeartbeatEvent>{{1, kFirstSeen, NmtState::kOperational},
                                                            {1, kLost, NmtState::kOperational}}));
}

}  // namespace
}  // namespace koboshi::canopen
