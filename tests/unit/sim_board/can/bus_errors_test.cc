#include <gtest/gtest.h>

#include "tests/unit/sim_board/can/bus_fixture.h"
#include "tests/unit/sim_board/can/bus_times.h"

namespace koboshi::sim_board {
namespace {

using hal::CanErrorState;
using test::length_us;
using test::make_frame;

constexpr std::uint64_t kErrorFrame_us = 20;  // flag, the others' flags, delimiter

// A sender and a receiver that takes everything, on a wire that can be disturbed.
struct BusErrors : testing::Test {
  BusErrors() { bus.set_disturbance(&destroyer); }

  Bus bus;
  test::Destroyer destroyer;
  test::ListeningNode sender, receiver;
  NodeHandle from = bus.attach(sender, AcceptanceFilter::all(), 8);
  NodeHandle to = bus.attach(receiver, AcceptanceFilter::all(), 8);
};

TEST_F(BusErrors, RepeatADestroyedFrame) {
  const hal::CanFrame frame = make_frame(0x123, {1, 2, 3});
  destroyer.left = 1;
  ASSERT_TRUE(bus.queue(from, frame, 0));
  bus.advance_to(1000);

  // The error shows when the CRC sequence is over, ten bits before the end of the frame.
  const std::uint64_t second_start_us = length_us(frame) - 10 + kErrorFrame_us + kIntermission_us;
  EXPECT_EQ(receiver.seen, (std::vector<test::SeenFrame>{{frame, second_start_us + length_us(frame)}}));
  EXPECT_EQ(bus.status(from).transmit_error_count, 7) << "eight up, one down";
  EXPECT_EQ(bus.status(to).receive_error_count, 0) << "one up, one down";
  EXPECT_EQ(bus.usage().error_frames, 1u);
}

TEST_F(BusErrors, EndInBusOffAndRecover) {
  destroyer.left = 32;
  ASSERT_TRUE(bus.queue(from, make_frame(0x123, {}), 0));
  bus.advance_to(1200);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorPassive);
  bus.advance_to(100000);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kBusOff);
  EXPECT_EQ(bus.status(to).receive_error_count, 32);
  EXPECT_EQ(bus.usage().error_frames, 32u);
  EXPECT_TRUE(receiver.seen.empty());

  bus.recover(from);
  bus.recover(from);  // the second changes nothing
  bus.advance_to(100000 + 128 * 11 - 1);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kBusOff);
  bus.advance_to(200000);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorActive);
  ASSERT_EQ(receiver.seen.size(), 1u) << "the frame was still in the FIFO";
  EXPECT_EQ(receiver.seen[0].time_us, 100000 + 128 * 11 + length_us(make_frame(0x123, {})));
}

TEST_F(BusErrors, ExtendARecoveryByAllButTheElevenRecessiveBitsOfEachFrame) {
  test::ListeningNode other;
  const NodeHandle third = bus.attach(other, {}, 8);
  destroyer.left = 32;
  ASSERT_TRUE(bus.queue(from, make_frame(0x123, {}), 0));
  bus.advance_to(10000);
  bus.recover(from);
  const hal::CanFrame frame = make_frame(0x100, {7, 7});
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(bus.queue(third, frame, 10100));
  const std::uint64_t expected_us = 10000 + 128 * 11 + 5 * (length_us(frame) + kIntermission_us - 11);
  bus.advance_to(expected_us - 1);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kBusOff);
  bus.advance_to(expected_us);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorActive);
}

TEST_F(BusErrors, SuspendAPassiveSenderForEightBits) {
  destroyer.left = 16;  // sixteen times eight: passive from then on
  ASSERT_TRUE(bus.queue(from, make_frame(0x123, {}), 0));
  ASSERT_TRUE(bus.queue(to, make_frame(0x124, {}), 0));  // of lower priority, waiting
  bus.advance_to(100000);
  ASSERT_EQ(sender.seen.size(), 1u);
  ASSERT_EQ(receiver.seen.size(), 1u);
  EXPECT_LT(sender.seen[0].time_us, receiver.seen[0].time_us);
}

// A short circuit in the middle of a frame.
TEST_F(BusErrors, OnADominantBusTurnTheSenderOffAndTheOthersPassive) {
  const hal::CanFrame frame = make_frame(0x123, {1, 2, 3});
  ASSERT_TRUE(bus.queue(from, frame, 0));
  bus.advance_to(20);
  bus.set_dominant(true);
  bus.advance_to(20 + 31 * 8);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorPassive);
  EXPECT_EQ(bus.status(to).receive_error_count, 128);
  bus.advance_to(20 + 32 * 8);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kBusOff);
  bus.recover(from);
  bus.advance_to(10'000);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kBusOff) << "no recessive bits";
  EXPECT_EQ(bus.status(to).state, CanErrorState::kErrorPassive);
  EXPECT_TRUE(sender.seen.empty());
  EXPECT_DOUBLE_EQ(bus_load({}, bus.usage()), 1.0);

  bus.set_dominant(false);
  bus.advance_to(10'000 + 128 * 11 + 1'000);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorActive);
  ASSERT_EQ(receiver.seen.size(), 1u) << "the frame was still in the FIFO";
  EXPECT_EQ(receiver.seen[0].time_us, 10'000u + 128 * 11 + length_us(frame));
}

TEST_F(BusErrors, FromAShortDominantPulseAreTolerated) {
  const hal::CanFrame frame = make_frame(0x123, {1, 2, 3});
  ASSERT_TRUE(bus.queue(from, frame, 0));
  bus.advance_to(20);
  bus.set_dominant(true);
  bus.advance_to(60);
  bus.set_dominant(false);
  bus.advance_to(1'000);
  EXPECT_EQ(receiver.seen, (std::vector<test::SeenFrame>{{frame, 60 + 11 + length_us(frame)}}));
  EXPECT_EQ(bus.status(from).transmit_error_count, 5 * 8 - 1);
  EXPECT_EQ(bus.status(to).receive_error_count, 5 * 8 - 1);
}

// A boot-up message and a heartbeat have one identifier, and wait in different FIFOs.
TEST(Bus, DoesNotLetALoneNodeAcknowledgeItself) {
  Bus bus;
  test::ListeningNode alone;
  const NodeHandle node = bus.attach(alone, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node, make_frame(0x701, {0}), 0));
  ASSERT_TRUE(bus.queue(node, make_frame(0x701, {5}), 0));
  bus.advance_to(100'000);
  EXPECT_EQ(bus.counters(node).sent, 0u);

  test::ListeningNode company;
  bus.attach(company, AcceptanceFilter::all(), 4);
  bus.advance_to(200'000);
  ASSERT_EQ(company.seen.size(), 2u);
  EXPECT_EQ(company.seen[0].frame.data[0], 0u) << "the boot-up comes first";
}

TEST(Bus, LeavesALoneNodeErrorPassive) {
  Bus bus;
  test::ListeningNode alone;
  const NodeHandle node = bus.attach(alone, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node, make_frame(0x701, {0}), 0));
  bus.advance_to(10'000'000);

  EXPECT_EQ(bus.status(node).state, CanErrorState::kErrorPassive);
  EXPECT_EQ(bus.status(node).transmit_error_count, 128);
  EXPECT_EQ(bus.counters(node).sent, 0u);
  EXPECT_EQ(bus.transmit_space(node, hal::kProcessFifo), 3u);  // where a boot-up message waits

  test::ListeningNode company;
  bus.attach(company, {0x701}, 4);
  bus.advance_to(10'001'000);
  EXPECT_EQ(bus.counters(node).sent, 1u);
  EXPECT_EQ(company.seen.size(), 1u);
}

TEST(Bus, EndsAnUnacknowledgedAttemptWithTheSendersOwnFlagOnly) {
  Bus bus;
  test::ListeningNode alone;
  const NodeHandle node = bus.attach(alone, {}, 4);
  const hal::CanFrame frame = make_frame(0x701, {0});
  ASSERT_TRUE(bus.queue(node, frame, 0));
  const std::uint64_t attempt_us = length_us(frame) - 8 + 6 + 8 + kIntermission_us;
  bus.advance_to(attempt_us);
  EXPECT_EQ(bus.usage().busy_us, attempt_us);
  EXPECT_EQ(bus.usage().error_frames, 1u);
  EXPECT_EQ(bus.status(node).transmit_error_count, 8);
  bus.advance_to(10 * attempt_us);  // none is shorter or longer
  EXPECT_EQ(bus.usage().busy_us, 10 * attempt_us);
  EXPECT_EQ(bus.usage().error_frames, 10u);
  EXPECT_EQ(bus.status(node).transmit_error_count, 80);
}

TEST(Bus, SendsTheSameFrameOfTwoNodesAtOnce) {
  Bus bus;
  test::ListeningNode a, b, c;
  const NodeHandle node_a = bus.attach(a, AcceptanceFilter::all(), 4);
  const NodeHandle node_b = bus.attach(b, AcceptanceFilter::all(), 4);
  bus.attach(c, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x080, {}), 5));
  ASSERT_TRUE(bus.queue(node_b, make_frame(0x080, {}), 5));
  bus.advance_to(1000);
  EXPECT_EQ(c.seen.size(), 1u);
  EXPECT_TRUE(a.seen.empty() && b.seen.empty());
  EXPECT_EQ(bus.counters(node_a).sent, 1u);
  EXPECT_EQ(bus.counters(node_b).sent, 1u);
  EXPECT_EQ(bus.usage().frames, 1u);
  EXPECT_EQ(bus.usage().collisions, 0u);
}

// Both count eight a collision. After sixteen both are error-passive: the one that sends the recessive bit
// can no longer disturb, so the stronger frame passes, then the weaker.
TEST(Bus, ResolvesACollisionOfContentsInFavourOfTheDominantBit) {
  Bus bus;
  test::ListeningNode a, b, c;
  const NodeHandle node_a = bus.attach(a, {}, 4);
  const NodeHandle node_b = bus.attach(b, {}, 4);
  const NodeHandle node_c = bus.attach(c, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x181, {0x55, 0x81}), 5));
  ASSERT_TRUE(bus.queue(node_b, make_frame(0x181, {0x55, 0x01}), 5));

  const auto first = test::encode(make_frame(0x181, {0x55, 0x81})).wire;
  const auto second = test::encode(make_frame(0x181, {0x55, 0x01})).wire;
  std::uint64_t prefix_us = 0;
  while (first[prefix_us] == second[prefix_us]) ++prefix_us;
  const std::uint64_t collision_us = prefix_us + 1 + kErrorFrame_us + kIntermission_us;
  bus.advance_to(5 + collision_us);
  EXPECT_EQ(bus.usage().busy_us, collision_us);
  EXPECT_EQ(bus.usage().collisions, 1u);
  EXPECT_EQ(bus.status(node_a).transmit_error_count, 8);
  EXPECT_EQ(bus.status(node_b).transmit_error_count, 8);
  EXPECT_EQ(bus.status(node_c).receive_error_count, 1);

  bus.advance_to(100000);
  ASSERT_EQ(c.seen.size(), 2u);
  EXPECT_EQ(c.seen[0].frame.data[1], 0x01);
  EXPECT_EQ(c.seen[1].frame.data[1], 0x81);
  EXPECT_EQ(bus.usage().collisions, 17u);
  EXPECT_EQ(bus.usage().error_frames, 16u);
}

TEST(Bus, CutsOffTheFrameOfANodeThatLosesPower) {
  Bus bus;
  test::ListeningNode a, b;
  const NodeHandle node_a = bus.attach(a, AcceptanceFilter::all(), 4);
  const NodeHandle node_b = bus.attach(b, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x181, {1}), 0));
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x181, {2}), 0));
  bus.advance_to(30);
  bus.power_off(node_a);
  EXPECT_FALSE(bus.queue(node_a, make_frame(0x181, {3}), 30));
  bus.advance_to(1000);
  EXPECT_TRUE(b.seen.empty());
  EXPECT_EQ(bus.usage().error_frames, 1u);
  EXPECT_EQ(bus.usage().busy_us, 30 + kErrorFrame_us + kIntermission_us);
  EXPECT_EQ(bus.status(node_b).receive_error_count, 1);

  bus.power_on(node_a);
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x181, {4}), 1000));
  bus.advance_to(2000);
  ASSERT_EQ(b.seen.size(), 1u);
  EXPECT_EQ(b.seen[0].frame.data[0], 4);
}

TEST(Bus, DeliversToALateNodeOnlyFramesThatStartAfterIt) {
  Bus bus;
  test::ListeningNode a, b, late;
  const NodeHandle node_a = bus.attach(a, {}, 4);
  bus.attach(b, {}, 4);
  const NodeHandle node_late = bus.attach(late, AcceptanceFilter::all(), 4);
  bus.power_off(node_late);
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x181, {1}), 0));
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x181, {2}), 0));
  bus.advance_to(20);
  bus.power_on(node_late);
  bus.advance_to(1000);
  ASSERT_EQ(late.seen.size(), 1u);
  EXPECT_EQ(late.seen[0].frame.data[0], 2);
}

}  // namespace
}  // namespace koboshi::sim_board
