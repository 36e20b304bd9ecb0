#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

constexpr NodeDescription watching() {
  NodeDescription description = kTestDescription;
  description.watched_tpdos = 255;
  return description;
}
constexpr NodeDescription kWatching = watching();

// A node in operational that has sent its first values.
class NodeWatchedTpdo : public testing::Test {
 protected:
  NodeWatchedTpdo() : device(0x10, kWatching) {
    device.make_operational();
    step(0);
    device.sink.take();
  }
  std::vector<hal::CanFrame> step(std::uint64_t now_us) {
    device.node.process(now_us);
    return device.sink.take();
  }
  // Sets other communication parameters for TPDO 2.
  void configure(const PdoConfiguration& configuration) {
    PdoConfiguration statusword = configuration;
    statusword.cob_id = 0x290;
    statusword.mapping = {mapping(0x6041, 0, 16)};
    ASSERT_EQ(device.node.configure_tpdo(1, statusword), AbortCode::kNone);
  }

  TestNode device;
};

TEST_F(NodeWatchedTpdo, IsSentOnlyWhenAValueHasChanged) {
  EXPECT_TRUE(step(1'000).empty());
  device.values.statusword = 0x1234;
  EXPECT_EQ(step(2'000), std::vector{can_frame(0x290, {0x34, 0x12})});
  EXPECT_TRUE(step(3'000).empty());
  device.values.position = 5;  // not mapped in this PDO
  EXPECT_TRUE(step(4'000).empty());
  device.values.statusword = 0;
  EXPECT_EQ(step(5'000), std::vector{can_frame(0x290, {0, 0})});
}

TEST_F(NodeWatchedTpdo, IsSentWhenOperationalBegins) {
  for (const NmtCommand command : {NmtCommand::kEnterPreOperational, NmtCommand::kStop}) {
    device.node.command(command, 0);
    EXPECT_TRUE(step(1'000).empty());
    device.node.command(NmtCommand::kStart, 2'000);
    EXPECT_EQ(step(3'000), std::vector{can_frame(0x290, {0, 0})});
    EXPECT_TRUE(step(4'000).empty());
  }
}

TEST_F(NodeWatchedTpdo, SendsTheLastValueAfterItsInhibitTime) {
  configure({.inhibit_time_100us = 50});
  EXPECT_EQ(step(10'000).size(), 1u);
  std::vector<unsigned> told;
  for (unsigned ms = 11; ms <= 25; ++ms) {
    device.values.statusword = static_cast<std::uint16_t>(ms);
    for (const hal::CanFrame& frame : step(1'000 * ms)) told.push_back(frame.data[0]);
  }
  EXPECT_EQ(told, (std::vector<unsigned>{15, 20, 25}));
}

TEST_F(NodeWatchedTpdo, OfTypeZeroIsSentAtTheSyncAfterAChange) {
  configure({.transmission_type = 0});
  EXPECT_EQ(device.ask(kSync).back().identifier, 0x290);  // the first values
  device.next_statusword = 0;
  EXPECT_EQ(device.ask(kSync).size(), 1u);
  device.values.statusword = device.next_statusword = 7;
  EXPECT_TRUE(step(1'000).empty());
  EXPECT_EQ(device.ask(kSync).back(), can_frame(0x290, {7, 0}));
  EXPECT_EQ(device.ask(kSync).size(), 1u);
  device.values.statusword = 9;  // a change counts as an event even if reverted before the SYNC
  EXPECT_TRUE(step(2'000).empty());
  device.values.statusword = 7;
  EXPECT_EQ(device.ask(kSync).back(), can_frame(0x290, {7, 0}));
}

// Type 254 is manufacturer-specific: with an event timer, only the timer triggers, as for sensors.
TEST_F(NodeWatchedTpdo, OfType254ReportsChangesOnlyWithoutAnEventTimer) {
  configure({.transmission_type = kEventManufacturer});
  EXPECT_EQ(step(1'000).size(), 1u);
  device.values.statusword = 1;
  EXPECT_EQ(step(2'000).size(), 1u);
  configure({.transmission_type = kEventManufacturer, .event_timer_ms = 20});
  EXPECT_EQ(step(3'000).size(), 1u);
  device.values.statusword = 2;
  EXPECT_TRUE(step(4'000).empty());
  EXPECT_EQ(step(23'000).size(), 1u);
}

TEST_F(NodeWatchedTpdo, IsNotSentTwiceWhenItsEventTimerRunsOutToo) {
  configure({.event_timer_ms = 10});
  EXPECT_EQ(step(1'000).size(), 1u);
  device.values.statusword = 1;
  EXPECT_EQ(step(11'000).size(), 1u);
  EXPECT_TRUE(step(12'000).empty());
}

TEST_F(NodeWatchedTpdo, StartsWhenItIsConfiguredInOperational) {
  ASSERT_EQ(device.node.write_object({0x1800, 2}, 255, 1), AbortCode::kNone);
  EXPECT_EQ(step(1'000).size(), 1u);
  device.values.torque = 3;
  const auto sent = step(2'000);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].identifier, 0x190);
}

TEST(NodeTpdo, BeyondTheWatchedOnesIsSentByTheOwner) {
  NodeDescription description = kTestDescription;
  description.watched_tpdos = 1;
  TestNode device(0x10, description);
  device.make_operational();
  device.values.statusword = 1;
  device.node.process(1'000);
  EXPECT_TRUE(device.sink.take().empty());
}

}  // namespace
}  // namespace koboshi::canopen
