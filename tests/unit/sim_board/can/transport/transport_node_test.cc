#include "sim_board/can/transport/transport_node.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/sim_board/can/transport/outside.h"

namespace koboshi::sim_board {
namespace {

class Inside final : public BusNode {
 public:
  void on_frame(const hal::CanFrame& frame, std::uint64_t) override { heard.push_back(frame); }
  std::vector<hal::CanFrame> heard;
};

class TransportNodeTest : public testing::Test {
 protected:
  const hal::CanFrame frame{.identifier = 0x123, .size = 1, .data = {7}};
  test::Outside outside;
  Inside inside;
  Bus bus;
  TransportNode node{bus, outside};
  NodeHandle handle = bus.attach(inside, AcceptanceFilter::all(), 4);
};

TEST_F(TransportNodeTest, ForwardsBusFramesWithTheirTimes) {
  ASSERT_TRUE(bus.queue(handle, frame, 100));
  bus.advance_to(1'000);
  EXPECT_EQ(outside.heard, std::vector{frame});
  EXPECT_GT(outside.times_us.at(0), 100u);
  EXPECT_LT(outside.times_us.at(0), 200u);
  EXPECT_EQ(node.counters().sent, 1u);
}

TEST_F(TransportNodeTest, ForwardsExternalFramesToTheBusWithoutEcho) {
  outside.said = {frame, {.identifier = 0x001}};
  node.poll(0);
  bus.advance_to(1'000);
  EXPECT_EQ(inside.heard, (std::vector<hal::CanFrame>{frame, {.identifier = 0x001}}));
  EXPECT_TRUE(outside.heard.empty());
  EXPECT_EQ(node.counters().received, 2u);
}

TEST_F(TransportNodeTest, IsNotBlockedByAListenerThatDoesNotRead) {
  outside.full = true;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(bus.queue(handle, frame, 0));
  bus.advance_to(1'000);
  EXPECT_EQ(node.counters().lost, 3u);
  EXPECT_EQ(bus.usage().frames, 3u);
}

TEST_F(TransportNodeTest, ReadsAFloodOnlyAsFastAsTheBusSendsIt) {
  for (int i = 0; i < 1'000; ++i) outside.said.push_back(frame);
  node.poll(0);
  EXPECT_EQ(node.counters().refused, 0u);
  EXPECT_EQ(outside.said.size(), 1'000 - TransportNode::kTransmitFifo);
}

TEST_F(TransportNodeTest, ForwardsProcessDataDuringAFloodOfServices) {
  for (int i = 0; i < 1'000; ++i) outside.said.push_back({.identifier = 0x601, .size = 8});
  outside.said.push_back({.identifier = 0x080});
  node.poll(0);
  bus.advance_to(200);
  ASSERT_FALSE(inside.heard.empty());
  EXPECT_EQ(inside.heard[0].identifier, 0x080);
  EXPECT_TRUE(outside.said.empty());
}

TEST_F(TransportNodeTest, CountsDroppedServices) {
  for (std::size_t i = 0; i < TransportNode::kServiceFifo + 10; ++i)
    outside.said.push_back({.identifier = 0x601, .size = 8});
  node.poll(0);
  EXPECT_EQ(node.counters().refused, 10u);
  EXPECT_EQ(node.counters().received, TransportNode::kServiceFifo + 10);
}

TEST_F(TransportNodeTest, CountsFramesForwardedBehindTheClock) {
  outside.said = {frame};
  node.poll(0, true);
  ASSERT_TRUE(bus.queue(handle, {.identifier = 0x124}, 0));
  bus.advance_to(1'000);
  EXPECT_EQ(node.counters().late_received, 1u);
  EXPECT_EQ(node.counters().late_sent, 1u);
  outside.said = {frame};
  node.poll(1'000, false);
  ASSERT_TRUE(bus.queue(handle, {.identifier = 0x124}, 1'000));
  bus.advance_to(2'000);
  EXPECT_EQ(node.counters().late_received, 1u);
  EXPECT_EQ(node.counters().late_sent, 1u);
}

TEST_F(TransportNodeTest, CountsFramesDelayedByABusyBus) {
  for (std::size_t i = 0; i < 200; ++i) outside.said.push_back({.identifier = 0x601, .size = 8});
  node.poll(0);
  bus.advance_to(100'000);
  const std::uint64_t late = node.counters().late_received;  // 10 ms are about 90 frames of 8 bytes
  EXPECT_GT(late, 100u);
  EXPECT_LT(late, 130u);
  EXPECT_EQ(bus.counters(handle).late, 0u);
}

TEST_F(TransportNodeTest, ReportsFramesDroppedByTheSystem) {
  outside.lost_by_system = 7;
  EXPECT_EQ(node.counters().dropped, 7u);
}

}  // namespace
}  // namespace koboshi::sim_board
