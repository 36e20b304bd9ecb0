#include "sim_board/can/transport/transport_node.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/sim_board/can/transport/outside.h"

namespace koboshi::sim {
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

TEST_F(TransportNodeTest, CarriesTheBusOutsideAtItsTimes) {
  ASSERT_TRUE(bus.queue(handle, frame, 100));
  bus.advance_to(1'000);
  EXPECT_EQ(outside.heard, std::vector{frame});
  EXPECT_GT(outside.times_us.at(0), 100u);
  EXPECT_LT(outside.times_us.at(0), 200u);
  EXPECT_EQ(node.counters().sent, 1u);
}

TEST_F(TransportNodeTest, BringsInWhatIsSaidOutsideAndDoesNotEchoIt) {
  outside.said = {frame, {.identifier = 0x001}};
  node.poll(0);
  bus.advance_to(1'000);
  EXPECT_EQ(inside.heard, (std::vector<hal::CanFrame>{frame, {.identifier = 0x001}}));
  EXPECT_TRUE(outside.heard.empty());
  EXPECT_EQ(node.counters().received, 2u);
}

TEST_F(TransportNodeTest, IsNotHeldUpByAListenerThatTakesNothing) {
  outside.full = true;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(bus.queue(handle, frame, 0));
  bus.advance_to(1'000);
  EXPECT_EQ(node.counters().lost, 3u);
  EXPECT_EQ(bus.usage().frames, 3u);
}

TEST_F(TransportNodeTest, LeavesAFloodOutside) {
  for (int i = 0; i < 1'000; ++i) outside.said.push_back(frame);
  node.poll(0);
  EXPECT_EQ(node.counters().refused, 0u);
  EXPECT_EQ(outside.said.size(), 1'000 - TransportNode::kTransmitFifo);
}

}  // namespace
}  // namespace koboshi::sim
