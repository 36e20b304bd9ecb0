#include <gtest/gtest.h>

#include <map>
#include <string_view>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

// Returns the milliseconds in which a node that is processed every millisecond sends frames with this
// identifier.
std::vector<int> send_times_ms(TestNode& device, std::uint16_t identifier, int from_ms, int until_ms) {
  std::vector<int> times_ms;
  for (int now_ms = from_ms; now_ms < until_ms; ++now_ms) {
    device.node.process(static_cast<std::uint64_t>(now_ms) * 1000);
    for (const hal::CanFrame& frame : device.sink.take()) {
      if (frame.identifier == identifier) times_ms.push_back(now_ms);
    }
  }
  return times_ms;
}

TEST(NodeTiming, HeartbeatKeepsItsPeriod) {
  NodeDescription description = kTestDescription;
  description.heartbeat_ms = 10;
  TestNode device(0x10, description);
  device.make_operational();
  EXPECT_EQ(send_times_ms(device, 0x710, 1, 45), (std::vector{10, 20, 30, 40}));
}

TEST(NodeTiming, HeartbeatRestartsWhenItsPeriodIsWritten) {
  TestNode device;
  device.make_operational();
  EXPECT_TRUE(send_times_ms(device, 0x710, 1, 100).empty());
  ASSERT_EQ(device.node.write_object({0x1017, 0}, 20, 2), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x710, 105, 150), (std::vector{105, 125, 145}));
  ASSERT_EQ(device.node.write_object({0x1017, 0}, 2, 2), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x710, 150, 155), (std::vector{150, 152, 154}));
}

TEST(NodeTiming, HeartbeatDoesNotCatchUpAfterAPause) {
  NodeDescription description = kTestDescription;
  description.heartbeat_ms = 10;
  TestNode device(0x10, description);
  device.make_operational();
  EXPECT_EQ(send_times_ms(device, 0x710, 75, 100), (std::vector{75, 85, 95}));
}

TEST(NodeTiming, SyncProducerKeepsItsPeriodAndReceivesItsOwnSync) {
  NodeDescription description = kTestDescription;
  description.sync_producer = true;
  description.sync_period_us = 5'000;
  TestNode device(0x10, description);
  device.make_operational();
  device.node.on_frame(can_frame(0x210, {0x0F, 0, 0, 0, 0, 0}), 0);
  EXPECT_EQ(send_times_ms(device, 0x080, 1, 16), (std::vector{5, 10, 15}));
  EXPECT_EQ(device.syncs, 3);
  EXPECT_EQ(device.values.controlword, 0x0F);
  device.node.command(NmtCommand::kStop, 16'000);
  EXPECT_TRUE(send_times_ms(device, 0x080, 16, 40).empty());
}

TEST(NodeTiming, SyncIsProducedOnlyByAProducer) {
  NodeDescription description = kTestDescription;
  description.sync_period_us = 5'000;
  TestNode device(0x10, description);
  device.make_operational();
  EXPECT_TRUE(send_times_ms(device, 0x080, 1, 20).empty());
}

TEST(NodeTiming, SyncOnDemandFollowsEarlierFrames) {
  NodeDescription description = kTestDescription;
  description.sync_producer = true;
  TestNode device(0x10, description);
  device.make_operational();
  device.node.trigger_tpdo(1, 0);
  device.node.send_sync(0);
  const auto sent = device.sink.take();
  ASSERT_EQ(sent.size(), 3u);
  EXPECT_EQ(sent[0].identifier, 0x290);
  EXPECT_EQ(sent[1], can_frame(0x080, {}));
  EXPECT_EQ(sent[2].identifier, 0x190);
}

TEST(NodeTiming, InhibitTimeSpacesEvents) {
  TestNode device;
  device.node.start(0);
  ASSERT_EQ(device.node.configure_tpdo(
                1, {.cob_id = 0x290, .inhibit_time_100us = 50, .mapping = {mapping(0x6041, 0, 16)}}),
            AbortCode::kNone);
  device.node.command(NmtCommand::kStart, 0);
  device.sink.frames.clear();
  device.node.trigger_tpdo(1, 0);
  EXPECT_EQ(device.sink.take().size(), 1u);
  device.node.trigger_tpdo(1, 1'000);
  device.node.trigger_tpdo(1, 2'000);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_EQ(send_times_ms(device, 0x290, 2, 30), std::vector{5});
  device.node.trigger_tpdo(1, 30'000);
  EXPECT_EQ(device.sink.take().size(), 1u);
}

TEST(NodeTiming, AnEventDoesNotOutliveOperationalOrItsConfiguration) {
  constexpr PdoConfiguration kSpaced{
      .cob_id = 0x290, .inhibit_time_100us = 50, .mapping = {mapping(0x6041, 0, 16)}};
  for (const bool reconfigure : {false, true}) {
    TestNode device;
    device.node.start(0);
    ASSERT_EQ(device.node.configure_tpdo(1, kSpaced), AbortCode::kNone);
    device.node.command(NmtCommand::kStart, 0);
    device.node.trigger_tpdo(1, 0);
    device.node.trigger_tpdo(1, 0);
    device.sink.frames.clear();
    if (reconfigure) {
      ASSERT_EQ(device.node.configure_tpdo(1, kSpaced), AbortCode::kNone);
    } else {
      device.node.command(NmtCommand::kEnterPreOperational, 0);
      device.node.process(10'000);
      EXPECT_TRUE(device.sink.take().empty());
      device.node.command(NmtCommand::kStart, 10'000);
    }
    device.node.process(20'000);
    EXPECT_TRUE(device.sink.take().empty());
  }
}

// Each case has sent a PDO whose inhibit time is 5 s.
TEST(NodeTiming, AnInhibitTimeDoesNotOutliveItsConfigurationOrAReset) {
  constexpr PdoConfiguration kSpaced{
      .cob_id = 0x290, .inhibit_time_100us = 50'000, .mapping = {mapping(0x6041, 0, 16)}};
  for (const std::string_view by : {"1800:01", "configure", "0x82", "0x81", "start"}) {
    SCOPED_TRACE(by);
    TestNode device;
    device.node.start(0);
    ASSERT_EQ(device.node.configure_tpdo(1, kSpaced), AbortCode::kNone);
    device.node.command(NmtCommand::kStart, 0);
    device.node.trigger_tpdo(1, 1'000);
    device.node.process(1'000);
    if (by == "1800:01") {
      ASSERT_EQ(device.node.write_object({0x1801, 1}, 0xC000'0290, 4), AbortCode::kNone);
      ASSERT_EQ(device.node.write_object({0x1801, 3}, 0, 2), AbortCode::kNone);
      ASSERT_EQ(device.node.write_object({0x1801, 1}, 0x4000'0290, 4), AbortCode::kNone);
    } else if (by == "configure") {
      ASSERT_EQ(device.node.configure_tpdo(1, kSpaced), AbortCode::kNone);
    } else {
      device.node.command(by == "0x82"   ? NmtCommand::kResetCommunication
                          : by == "0x81" ? NmtCommand::kResetNode
                                         : NmtCommand::kEnterPreOperational,
                          2'000);
      device.node.command(NmtCommand::kStart, 2'000);
    }
    device.sink.frames.clear();
    device.node.trigger_tpdo(1, 3'000);
    EXPECT_EQ(device.sink.take().size(), 1u);
  }
}

TEST(NodeTiming, AnInhibitTimeOutlivesOtherChangesOfAPdo) {
  TestNode device;
  device.node.start(0);
  ASSERT_EQ(device.node.configure_tpdo(
                1, {.cob_id = 0x290, .inhibit_time_100us = 50, .mapping = {mapping(0x6041, 0, 16)}}),
            AbortCode::kNone);
  device.node.command(NmtCommand::kStart, 0);
  device.node.trigger_tpdo(1, 0);
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 1'000, 2), AbortCode::kNone);
  device.sink.frames.clear();
  device.node.trigger_tpdo(1, 1'000);
  EXPECT_EQ(send_times_ms(device, 0x290, 1, 30), std::vector{5});
}

TEST(NodeTiming, SyncPeriodRestartsWhenItIsWritten) {
  NodeDescription description = kTestDescription;
  description.sync_producer = true;
  TestNode device(0x10, description);
  device.make_operational();
  EXPECT_TRUE(send_times_ms(device, 0x080, 1, 50).empty());
  ASSERT_EQ(device.node.write_object({0x1006, 0}, 20'000, 4), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x080, 50, 95), (std::vector{50, 70, 90}));
  ASSERT_EQ(device.node.write_object({0x1006, 0}, 2'000, 4), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x080, 95, 100), (std::vector{95, 97, 99}));
}

TEST(NodeTiming, SyncIdentifierChangesOnlyWhileNotProducing) {
  TestNode device;
  device.make_operational();
  EXPECT_EQ(device.node.write_object({0x1005, 0}, 0x40000080, 4), AbortCode::kNone);
  EXPECT_EQ(device.node.write_object({0x1005, 0}, 0x40000081, 4), AbortCode::kInvalidValue);
  EXPECT_EQ(device.node.write_object({0x1005, 0}, 0x00000080, 4), AbortCode::kNone);
  EXPECT_EQ(device.node.write_object({0x1005, 0}, 0x00000601, 4), AbortCode::kInvalidValue);
  EXPECT_EQ(device.node.write_object({0x1005, 0}, 0x000000C0, 4), AbortCode::kNone);
  EXPECT_TRUE(device.ask(can_frame(0x080, {})).empty());
  EXPECT_EQ(device.ask(can_frame(0x0C0, {})).size(), 1u);
}

TEST(NodeTiming, EventTimerRepeatsAndRestartsAtEachTransmission) {
  TestNode device;
  device.node.start(0);
  ASSERT_EQ(device.node.configure_tpdo(
                1, {.cob_id = 0x290, .event_timer_ms = 10, .mapping = {mapping(0x6041, 0, 16)}}),
            AbortCode::kNone);
  device.node.command(NmtCommand::kStart, 0);
  device.sink.frames.clear();
  EXPECT_EQ(send_times_ms(device, 0x290, 1, 25), (std::vector{10, 20}));
  device.node.trigger_tpdo(1, 25'000);
  EXPECT_EQ(device.sink.take().size(), 1u);
  EXPECT_EQ(send_times_ms(device, 0x290, 26, 50), (std::vector{35, 45}));
}

// A new time counts from the next cycle, which sends the PDO, whatever is left of the old one.
TEST(NodeTiming, EventTimerRestartsWhenItIsWritten) {
  TestNode device;
  device.node.start(0);
  ASSERT_EQ(device.node.configure_tpdo(
                1, {.cob_id = 0x290, .event_timer_ms = 5'000, .mapping = {mapping(0x6041, 0, 16)}}),
            AbortCode::kNone);
  device.node.command(NmtCommand::kStart, 0);
  device.sink.frames.clear();
  EXPECT_TRUE(send_times_ms(device, 0x290, 1, 50).empty());
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 20, 2), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x290, 50, 100), (std::vector{50, 70, 90}));
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 0, 2), AbortCode::kNone);
  EXPECT_TRUE(send_times_ms(device, 0x290, 100, 200).empty());
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 20, 2), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x290, 200, 250), (std::vector{200, 220, 240}));
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 5'000, 2), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x290, 250, 300), std::vector{250});
  ASSERT_EQ(device.node.write_object({0x1801, 1}, 0xC000'0290, 4), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 10, 2), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1801, 1}, 0x4000'0290, 4), AbortCode::kNone);
  EXPECT_EQ(send_times_ms(device, 0x290, 300, 325), (std::vector{300, 310, 320}));
}

TEST(NodeTiming, SyncCountersRestartWithOperational) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1800, 2}, 2, 1), AbortCode::kNone);
  EXPECT_TRUE(device.ask(can_frame(0x080, {})).empty());
  device.node.command(NmtCommand::kEnterPreOperational, 0);
  device.node.command(NmtCommand::kStart, 0);
  EXPECT_TRUE(device.ask(can_frame(0x080, {})).empty());
  EXPECT_EQ(device.ask(can_frame(0x080, {})).size(), 1u);
}

}  // namespace
}  // namespace koboshi::canopen
