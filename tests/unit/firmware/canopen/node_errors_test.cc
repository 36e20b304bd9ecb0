#include <gtest/gtest.h>

#include <optional>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

using hal::CanErrorState;

std::vector<hal::CanFrame> tell(TestNode& device, hal::CanStatus status) {
  device.sink.frames.clear();
  device.node.on_can_status(status, 0);
  return device.sink.take();
}

hal::CanFrame emergency(unsigned code, unsigned error_register, unsigned detail = 0) {
  return can_frame(0x090, {code & 0xFF, code >> 8, error_register, detail, 0, 0, 0, 0});
}

TEST(NodeCanStatus, ReportsErrorPassiveWhileItLasts) {
  TestNode device;
  device.make_operational();
  EXPECT_TRUE(tell(device, {}).empty());
  EXPECT_EQ(tell(device, {.state = CanErrorState::kErrorPassive}), std::vector{emergency(0x8120, 0x11)});
  EXPECT_TRUE(tell(device, {.state = CanErrorState::kErrorPassive}).empty());
  EXPECT_EQ(tell(device, {}), std::vector{emergency(0, 0)});
}

TEST(NodeCanStatus, ReportsEveryOverrun) {
  TestNode device;
  device.make_operational();
  EXPECT_EQ(tell(device, {.receive_overruns = 3}), std::vector{emergency(0x8110, 0x11)});
  EXPECT_TRUE(tell(device, {.receive_overruns = 5}).empty());
  EXPECT_EQ(tell(device, {.receive_overruns = 5}), std::vector{emergency(0, 0)});
  EXPECT_EQ(tell(device, {.receive_overruns = 6}), std::vector{emergency(0x8110, 0x11)});
}

TEST(NodeCanStatus, ReportsTheRecoveryFromBusOff) {
  TestNode device;
  device.make_operational();
  tell(device, {.state = CanErrorState::kBusOff});
  EXPECT_EQ(device.node.state(), NmtState::kPreOperational);
  EXPECT_EQ(tell(device, {}), (std::vector{emergency(0x8140, 0x11), emergency(0, 0x11)}));
  EXPECT_EQ(tell(device, {}), std::vector{emergency(0, 0)});
  EXPECT_EQ(device.node.state(), NmtState::kPreOperational);
}

// --- Lost heartbeats

// A node that expects node 1's heartbeat every 60 ms and received the last one at time 0.
class NodeWatchesHeartbeats : public testing::Test {
 protected:
  NodeWatchesHeartbeats() {
    description.heartbeat_ms = 100;
    device.emplace(0x10, description);
    device->make_operational();
    EXPECT_EQ(device->node.configure_consumer(0, 1, 60), AbortCode::kNone);
    device->node.on_frame(can_frame(0x701, {5}), 0);
  }
  // Returns the millisecond at which the heartbeat is lost, or -1 if it never is.
  int lost_at_ms(int from_ms, int until_ms) {
    for (int now_ms = from_ms; now_ms < until_ms; ++now_ms) {
      device->heartbeats.clear();
      device->node.process(static_cast<std::uint64_t>(now_ms) * 1'000);
      for (const HeartbeatEvent& event : device->heartbeats) {
        if (event.kind == HeartbeatEventKind::kLost) return now_ms;
      }
    }
    return -1;
  }

  NodeDescription description = kTestDescription;
  std::optional<TestNode> device;
};

TEST_F(NodeWatchesHeartbeats, ReportsALossInTimeOnAFreeBus) { EXPECT_EQ(lost_at_ms(1, 200), 60); }

TEST_F(NodeWatchesHeartbeats, ReportsNoLossWhileItsOwnHeartbeatsAreBlocked) {
  EXPECT_EQ(lost_at_ms(1, 30), -1);
  device->sink.beats_wait = true;
  EXPECT_EQ(lost_at_ms(30, 1'000), -1);
  device->sink.beats_wait = false;
  EXPECT_EQ(lost_at_ms(1'000, 1'200), 999 + 60);
}

TEST_F(NodeWatchesHeartbeats, ReportsALossWhenItsOwnWaitLessThanACycle) {
  for (int now_ms = 1; now_ms < 60; ++now_ms) {
    device->sink.beats_wait = now_ms % 10 != 0;
    ASSERT_EQ(lost_at_ms(now_ms, now_ms + 1), -1);
  }
  device->sink.beats_wait = false;
  EXPECT_EQ(lost_at_ms(60, 61), 60);
}

// The other nodes cannot delay it here: no node acknowledges its frames.
TEST_F(NodeWatchesHeartbeats, ReportsALossWhenAlone) {
  device->sink.beats_wait = true;
  device->node.on_can_status({.state = CanErrorState::kErrorPassive}, 1'000);
  EXPECT_EQ(lost_at_ms(1, 200), 60);
}

TEST_F(NodeWatchesHeartbeats, SendsAnEarlyHeartbeatToProbeTheBusBeforeItReportsALoss) {
  std::vector<int> beats_ms;
  for (int now_ms = 1; now_ms < 60; ++now_ms) {
    EXPECT_EQ(lost_at_ms(now_ms, now_ms + 1), -1);
    for (const hal::CanFrame& frame : device->sink.take()) {
      if (frame.identifier == 0x710) beats_ms.push_back(now_ms);
    }
  }
  EXPECT_EQ(beats_ms, (std::vector<int>{40, 50}));
}

TEST(NodeHeartbeat, IsDroppedWhenTheFifoIsFull) {
  NodeDescription description = kTestDescription;
  description.heartbeat_ms = 10;
  TestNode device(0x10, description);
  device.make_operational();
  device.sink.room = 0;
  for (std::uint64_t now_us = 0; now_us < 1'000'000; now_us += 1'000) device.node.process(now_us);
  EXPECT_EQ(device.node.backlog(), 0u);
  EXPECT_EQ(device.node.lost_frames(), 0u);
}

// --- Foreign senders of this node's identifiers

TEST(NodeImpostor, IsDetectedByItsHeartbeatSyncEmergencyOrPdo) {
  NodeDescription description = kTestDescription;
  description.sync_producer = true;
  description.sync_period_us = 5'000;
  TestNode device(0x10, description);
  device.make_operational();
  const std::uint16_t tpdo = 0x190;
  ASSERT_EQ(device.node.configure_tpdo(0, {.cob_id = tpdo, .transmission_type = 1, .mapping = {0x6041'0010}}),
            AbortCode::kNone);
  for (const hal::CanFrame& frame :
       {can_frame(0x710, {5}), can_frame(0x710, {0}), can_frame(0x080, {}),
        can_frame(0x090, {0, 0x10, 0, 0, 0, 0, 0, 0}), can_frame(tpdo, {0, 0})}) {
    device.impostors.clear();
    device.node.on_frame(frame, 0);
    EXPECT_EQ(device.impostors, std::vector{frame.identifier});
  }
  device.impostors.clear();
  for (const hal::CanFrame& frame :
       {can_frame(0x711, {5}), can_frame(0x091, {0, 0x10, 0, 0, 0, 0, 0, 0}), can_frame(0x191, {0, 0}),
        can_frame(0x210, {0x0F, 0, 0, 0, 0, 0}), can_frame(0x610, {0x40, 0, 0x10, 0, 0, 0, 0, 0}),
        can_frame(0x000, {1, 0})})
    device.node.on_frame(frame, 0);
  EXPECT_TRUE(device.impostors.empty());
}

// A node without PDOs still hears that another one sends its PDO.
TEST(NodeImpostor, IsDetectedByItsPdoInPreOperationalToo) {
  TestNode device;
  device.node.start(0);
  device.node.process(0);
  ASSERT_EQ(device.node.state(), NmtState::kPreOperational);
  device.node.on_frame(can_frame(0x190, {0, 0, 0, 0, 0, 0, 0, 0}), 0);
  EXPECT_EQ(device.impostors, std::vector<std::uint16_t>{0x190});
  device.node.on_frame(can_frame(0x210, {0, 0, 0, 0, 0, 0}),
                       0);  // an RPDO that it would receive if operational
  EXPECT_EQ(device.impostors.size(), 1u);
}

TEST(NodeImpostor, IsNoSyncProducerIfTheNodeIsNot) {
  TestNode device;
  device.make_operational();
  device.node.on_frame(can_frame(0x080, {}), 0);
  EXPECT_TRUE(device.impostors.empty());
}

TEST(NodeMute, SendsNothingUntilUnmuted) {
  TestNode device;
  device.make_operational();
  device.node.mute(true);
  EXPECT_TRUE(device.ask(can_frame(0x610, {0x40, 0, 0x10, 0, 0, 0, 0, 0})).empty());
  device.node.mute(false);
  EXPECT_EQ(device.ask(can_frame(0x610, {0x40, 0, 0x10, 0, 0, 0, 0, 0})).size(), 1u);
}

// CiA 301, object 0x1029, in each state that can lose a heartbeat.
TEST(NodeErrorBehaviour, ActsOnALostHeartbeat) {
  struct Case {
    unsigned behaviour;
    NmtState before;
    NmtState after;
  };
  using enum NmtState;
  constexpr Case kCases[] = {
      {0, kOperational, kPreOperational}, {0, kPreOperational, kPreOperational}, {0, kStopped, kStopped},
      {1, kOperational, kOperational},    {1, kPreOperational, kPreOperational}, {1, kStopped, kStopped},
      {2, kOperational, kStopped},        {2, kPreOperational, kStopped},        {2, kStopped, kStopped},
  };
  for (const Case& test : kCases) {
    SCOPED_TRACE(testing::Message() << test.behaviour << " in " << int(test.before));
    TestNode device;
    device.make_operational();
    ASSERT_EQ(device.node.write_object({0x1029, 1}, test.behaviour, 1), AbortCode::kNone);
    ASSERT_EQ(device.node.configure_consumer(0, 1, 100), AbortCode::kNone);
    if (test.before == kPreOperational) device.node.command(NmtCommand::kEnterPreOperational, 0);
    if (test.before == kStopped) device.node.command(NmtCommand::kStop, 0);
    device.node.on_frame(can_frame(0x701, {5}), 0);
    device.node.process(100'000);
    EXPECT_EQ(device.node.state(), test.after);
  }
}

TEST(NodeErrorBehaviour, ReportsTheLossAndTheReturn) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.configure_consumer(0, 1, 100), AbortCode::kNone);
  ASSERT_EQ(device.node.configure_consumer(1, 2, 100), AbortCode::kNone);
  device.node.on_frame(can_frame(0x701, {5}), 0);
  device.node.on_frame(can_frame(0x702, {5}), 0);
  device.node.process(100'000);
  EXPECT_EQ(device.sink.take(), std::vector{emergency(0x8130, 0x11, 1)});
  EXPECT_TRUE(device.ask(can_frame(0x701, {5}), 110'000).empty());
  EXPECT_EQ(device.ask(can_frame(0x702, {5}), 110'000), std::vector{emergency(0, 0)});
}

TEST(NodeErrorBehaviour, KeepsAnErrorThatItsOwnerStillReports) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.configure_consumer(0, 1, 100), AbortCode::kNone);
  device.node.on_frame(can_frame(0x701, {5}), 0);
  device.node.process(100'000);
  device.node.raise_error(error_code::kHeartbeat, error_register::kCommunication);
  EXPECT_EQ(device.sink.take().size(), 1u);
  EXPECT_TRUE(device.ask(can_frame(0x701, {5}), 110'000).empty());
  device.node.clear_error(error_code::kHeartbeat);
  EXPECT_EQ(device.sink.take(), std::vector{emergency(0, 0)});
}

TEST(NodeErrorBehaviour, AnErrorEndsWhenItsConsumerIsRemoved) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.configure_consumer(0, 1, 100), AbortCode::kNone);
  device.node.on_frame(can_frame(0x701, {5}), 0);
  device.node.process(100'000);
  device.sink.frames.clear();
  ASSERT_EQ(device.node.write_object({0x1016, 1}, 0, 4), AbortCode::kNone);
  EXPECT_EQ(device.sink.take(), std::vector{emergency(0, 0)});
}

TEST(NodeRpdoTimer, ReportsAPdoThatFallsSilent) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1401, 5}, 10, 2), AbortCode::kNone);
  device.node.process(50'000);
  EXPECT_TRUE(device.sink.take().empty());  // the consumer's timer starts at the first reception
  device.node.on_frame(can_frame(0x310, {7, 0}), 50'000);
  device.node.on_frame(can_frame(0x310, {7, 0}), 55'000);
  device.node.process(64'999);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_TRUE(device.silent_rpdos.empty());
  device.node.process(65'000);
  EXPECT_EQ(device.sink.take(), std::vector{emergency(0x8250, 0x11, 2)});
  device.node.process(200'000);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_EQ(device.silent_rpdos, std::vector<std::size_t>{1});
  EXPECT_EQ(device.ask(can_frame(0x310, {7, 0}), 200'000), std::vector{emergency(0, 0)});
}

TEST(NodeRpdoTimer, IsInactiveOutsideOperational) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1401, 5}, 10, 2), AbortCode::kNone);
  device.node.on_frame(can_frame(0x310, {7, 0}), 0);
  device.node.command(NmtCommand::kEnterPreOperational, 5'000);
  device.node.process(20'000);
  EXPECT_TRUE(device.sink.take().empty());
}

}  // namespace
}  // namespace koboshi::canopen
