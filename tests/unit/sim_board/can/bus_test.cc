#include "sim_board/can/bus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "tests/unit/sim_board/can/bus_fixture.h"
#include "tests/unit/sim_board/can/bus_times.h"

namespace koboshi::sim_board {
namespace {

using test::length_us;
using test::make_frame;

TEST(Bus, DeliversAtTheEndOfTheLastBit) {
  Bus bus;
  test::ListeningNode sender, receiver;
  const NodeHandle from = bus.attach(sender, AcceptanceFilter::all(), 4);
  bus.attach(receiver, AcceptanceFilter::all(), 4);
  const hal::CanFrame sync = make_frame(0x080, {});
  ASSERT_TRUE(bus.queue(from, sync, 1000));

  bus.advance_to(1047);
  EXPECT_TRUE(receiver.seen.empty());
  bus.advance_to(1048);  // 44 bits and 4 stuff bits, see FrameBits.EqualAHandMadeSync

  EXPECT_EQ(receiver.seen, (std::vector<test::SeenFrame>{{sync, 1048}}));
  EXPECT_TRUE(sender.seen.empty()) << "nobody receives what it sends";
}

TEST(Bus, ScalesWithTheBitTime) {
  Bus bus(8);  // 125 kbit/s
  test::ListeningNode sender, receiver;
  const NodeHandle from = bus.attach(sender, {}, 4);
  bus.attach(receiver, {0x080}, 4);
  ASSERT_TRUE(bus.queue(from, make_frame(0x080, {}), 100));
  bus.advance_to(10000);
  ASSERT_EQ(receiver.seen.size(), 1u);
  EXPECT_EQ(receiver.seen[0].time_us, 100u + 48 * 8);
}

TEST(Bus, LetsTheLowestIdentifierOfTheReadyHeadsWin) {
  Bus bus;
  test::ListeningNode a, b, c, receiver;
  const NodeHandle node_a = bus.attach(a, {}, 4);
  const NodeHandle node_b = bus.attach(b, {}, 4);
  const NodeHandle node_c = bus.attach(c, {}, 4);
  bus.attach(receiver, AcceptanceFilter::all(), 4);
  // Each node's frames leave in their order, so 0x100 waits behind 0x300 of the same node.
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x300, {}), 10));
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x100, {}), 10));
  ASSERT_TRUE(bus.queue(node_b, make_frame(0x200, {}), 10));
  ASSERT_TRUE(bus.queue(node_c, make_frame(0x180, {}), 11));  // too late for the first arbitration
  bus.advance_to(10000);

  std::vector<int> order;
  for (const test::SeenFrame& seen : receiver.seen) order.push_back(seen.frame.identifier);
  EXPECT_EQ(order, (std::vector<int>{0x200, 0x180, 0x300, 0x100}));
}

// A heartbeat that loses every arbitration delays the PDOs of its node by nothing, and a PDO that is being
// sent no longer than any other frame.
TEST(Bus, DoesNotDelayProcessDataBehindAServiceOfTheSameNode) {
  Bus bus;
  test::ListeningNode one, flood, receiver;
  const NodeHandle node = bus.attach(one, {}, 4);
  const NodeHandle other = bus.attach(flood, {}, 64);
  bus.attach(receiver, AcceptanceFilter::all(), 4);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(bus.queue(other, make_frame(0x601, {1, 2, 3, 4, 5, 6, 7, 8}), 0));
  for (const std::uint16_t identifier :
       std::initializer_list<std::uint16_t>{0x701, 0x210, 0x080, 0x581, 0x211})
    ASSERT_TRUE(bus.queue(node, make_frame(identifier, {}), 10));
  bus.advance_to(10'000);

  std::vector<int> order;
  for (const test::SeenFrame& seen : receiver.seen) order.push_back(seen.frame.identifier);
  ASSERT_EQ(order.size(), 25u);
  EXPECT_EQ((std::vector<int>(order.begin(), order.begin() + 5)),
            (std::vector<int>{0x601, 0x210, 0x080, 0x211, 0x581}));
  EXPECT_EQ(order.back(), 0x701);
}

TEST(Bus, GivesEachFifoItsOwnCapacity) {
  Bus bus;
  test::ListeningNode sender, receiver;
  const NodeHandle from = bus.attach(sender, {}, {1, 2, 1});
  bus.attach(receiver, AcceptanceFilter::all(), 1);
  EXPECT_TRUE(bus.queue(from, make_frame(0x600, {}), 0));
  EXPECT_FALSE(bus.queue(from, make_frame(0x7FF, {}), 0));
  EXPECT_TRUE(bus.queue(from, make_frame(0x580, {}), 0));
  EXPECT_TRUE(bus.queue(from, make_frame(0x5FF, {}), 0));
  EXPECT_FALSE(bus.queue(from, make_frame(0x580, {}), 0));
  EXPECT_TRUE(bus.queue(from, make_frame(0x57F, {}), 0));
  EXPECT_FALSE(bus.queue(from, make_frame(0x000, {}), 0));
  EXPECT_EQ(bus.transmit_space(from, hal::kProcessFifo), 0u);
  EXPECT_EQ(bus.counters(from).overruns, 3u);
  bus.advance_to(1'000);
  EXPECT_EQ(receiver.seen.size(), 4u);
}

TEST(Bus, LetsADataFrameWinAgainstARemoteFrameOfTheSameIdentifier) {
  Bus bus;
  test::ListeningNode a, b, receiver;
  const NodeHandle node_a = bus.attach(a, {}, 4);
  const NodeHandle node_b = bus.attach(b, {}, 4);
  bus.attach(receiver, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node_a, {.identifier = 0x701, .size = 1, .remote = true, .data = {}}, 10));
  ASSERT_TRUE(bus.queue(node_b, make_frame(0x701, {5}), 10));
  bus.advance_to(1000);
  ASSERT_EQ(receiver.seen.size(), 2u);
  EXPECT_FALSE(receiver.seen[0].frame.remote);
  EXPECT_TRUE(receiver.seen[1].frame.remote);
  EXPECT_EQ(bus.usage().error_frames, 0u);
}

TEST(Bus, IncludesFramesQueuedInTheMicrosecondOfArbitration) {
  Bus bus;
  test::ListeningNode a, b;
  const NodeHandle node_a = bus.attach(a, AcceptanceFilter::all(), 4);
  const NodeHandle node_b = bus.attach(b, AcceptanceFilter::all(), 4);
  ASSERT_TRUE(bus.queue(node_a, make_frame(0x300, {}), 500));
  bus.advance_to(500);
  ASSERT_TRUE(bus.queue(node_b, make_frame(0x200, {}), 500));
  bus.advance_to(2000);
  ASSERT_EQ(a.seen.size(), 1u);
  EXPECT_EQ(a.seen[0].time_us, 500 + length_us(make_frame(0x200, {})));
}

TEST(Bus, DeliversOnlyWhatTheFilterAccepts) {
  Bus bus;
  test::ListeningNode sender, one, two;
  const NodeHandle from = bus.attach(sender, {}, 4);
  const NodeHandle node_one = bus.attach(one, {0x080, 0x201}, 4);
  AcceptanceFilter range;
  range.accept_range(0x200, 0x27F);
  bus.attach(two, range, 4);
  for (const std::uint16_t identifier : std::initializer_list<std::uint16_t>{0x080, 0x201, 0x202}) {
    ASSERT_TRUE(bus.queue(from, make_frame(identifier, {}), 0));
  }
  bus.advance_to(1000);
  EXPECT_EQ(one.seen.size(), 2u);
  EXPECT_EQ(two.seen.size(), 2u);

  bus.set_filter(node_one, {0x300});
  ASSERT_TRUE(bus.queue(from, make_frame(0x080, {}), 1000));
  ASSERT_TRUE(bus.queue(from, make_frame(0x300, {}), 1000));
  bus.advance_to(2000);
  ASSERT_EQ(one.seen.size(), 3u);
  EXPECT_EQ(one.seen[2].frame.identifier, 0x300);
}

TEST(Bus, LetsANodeChangeItsFilterWhileItReceives) {
  Bus bus;
  test::ListeningNode sender, one, two;
  const NodeHandle from = bus.attach(sender, {}, 4);
  const NodeHandle node_one = bus.attach(one, {0x100}, 4);
  const NodeHandle node_two = bus.attach(two, {0x100}, 4);
  one.answer = [&](const hal::CanFrame&, std::uint64_t) {
    bus.set_filter(node_one, {0x101});
    bus.set_filter(node_two, {0x102});
  };
  for (const std::uint16_t identifier : std::initializer_list<std::uint16_t>{0x100, 0x101, 0x102}) {
    ASSERT_TRUE(bus.queue(from, make_frame(identifier, {}), 0));
  }
  bus.advance_to(1000);
  ASSERT_EQ(one.seen.size(), 2u);
  EXPECT_EQ(one.seen[1].frame.identifier, 0x101);
  ASSERT_EQ(two.seen.size(), 2u) << "the frame that was being delivered, and what it accepts now";
  EXPECT_EQ(two.seen[1].frame.identifier, 0x102);
}

// More nodes than a word of the table of receivers has bits.
TEST(Bus, DeliversToEachOfManyNodes) {
  Bus bus;
  test::ListeningNode sender;
  const NodeHandle from = bus.attach(sender, {}, 4);
  std::deque<test::ListeningNode> nodes(150);
  std::vector<NodeHandle> handles;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    handles.push_back(bus.attach(nodes[i], {0x080, static_cast<std::uint16_t>(0x200 + i)}, 4));
  ASSERT_TRUE(bus.queue(from, make_frame(0x080, {}), 0));
  ASSERT_TRUE(bus.queue(from, make_frame(0x200 + 99, {}), 0));
  ASSERT_TRUE(bus.queue(handles[149], make_frame(0x200 + 64, {}), 0));
  bus.advance_to(1000);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    EXPECT_EQ(nodes[i].seen.size(), i == 99 || i == 64 ? 2u : 1u) << i;
}

TEST(Bus, CountsFramesDroppedByAFullTransmitFifo) {
  Bus bus;
  test::ListeningNode sender, receiver;
  const NodeHandle from = bus.attach(sender, {}, 2);
  bus.attach(receiver, AcceptanceFilter::all(), 2);
  EXPECT_TRUE(bus.queue(from, make_frame(0x100, {}), 0));
  EXPECT_TRUE(bus.queue(from, make_frame(0x101, {}), 0));
  EXPECT_FALSE(bus.queue(from, make_frame(0x102, {}), 0));
  bus.advance_to(10);  // the frame on the wire keeps its place
  EXPECT_EQ(bus.transmit_space(from, hal::kProcessFifo), 0u);
  bus.advance_to(60);
  EXPECT_EQ(bus.transmit_space(from, hal::kProcessFifo), 1u);
  EXPECT_EQ(bus.counters(from).overruns, 1u);
  bus.advance_to(1000);
  EXPECT_EQ(bus.counters(from).sent, 2u);
  EXPECT_EQ(receiver.seen.size(), 2u);
}

TEST(Bus, MeasuresItsLoadWithIntermission) {
  Bus bus;
  test::ListeningNode sender, receiver;
  const NodeHandle from = bus.attach(sender, {}, 4);
  bus.attach(receiver, {}, 4);
  const BusUsage before = bus.usage();
  ASSERT_TRUE(bus.queue(from, make_frame(0x080, {}), 100));
  bus.advance_to(110);
  EXPECT_EQ(bus.usage().busy_us, 10u);
  bus.advance_to(149);
  EXPECT_EQ(bus.usage().busy_us, 49u);
  bus.advance_to(1000);
  EXPECT_EQ(bus.usage().busy_us, 48 + kIntermission_us);
  EXPECT_DOUBLE_EQ(bus_load(before, bus.usage()), 0.051);
  EXPECT_EQ(bus.usage().frames, 1u);
}

TEST(Bus, NotifiesTheObserverBeforeAnyNode) {
  Bus bus;
  test::ListeningNode sender, receiver;
  test::ListeningObserver observer;
  bus.set_observer(&observer);
  const NodeHandle from = bus.attach(sender, {}, 4);
  bus.attach(receiver, AcceptanceFilter::all(), 4);
  std::size_t observed_first = 0;
  receiver.answer = [&](const hal::CanFrame&, std::uint64_t) { observed_first = observer.seen.size(); };
  ASSERT_TRUE(bus.queue(from, make_frame(0x080, {}), 7));
  bus.advance_to(1000);
  ASSERT_EQ(observer.seen.size(), 1u);
  EXPECT_EQ(observer.seen[0].start_us, 7u);
  EXPECT_EQ(observer.seen[0].end_us, 55u);
  EXPECT_EQ(observed_first, 1u);
}

TEST(Bus, CarriesNothingBeyondAFramesSize) {
  Bus bus;
  test::ListeningNode sender, receiver;
  const NodeHandle from = bus.attach(sender, {}, 4);
  bus.attach(receiver, AcceptanceFilter::all(), 4);
  hal::CanFrame frame = make_frame(0x181, {1, 2});
  frame.data[5] = 99;
  ASSERT_TRUE(bus.queue(from, frame, 0));
  bus.advance_to(1000);
  ASSERT_EQ(receiver.seen.size(), 1u);
  EXPECT_EQ(receiver.seen[0].frame, make_frame(0x181, {1, 2}));
}

// The schedule of a control cycle: 20 RPDOs and SYNC from the controller, ready at 1000 us; each drive
// answers SYNC with its TPDO after a time of its own, so that they queue up and leave by identifier. Drive 3
// answers 0.5 ms late, when the others are still leaving; a heartbeat of drive 7 has the bus when the RPDOs
// become ready.
TEST(Bus, KeepsAHandMadeScheduleToTheMicrosecond) {
  constexpr std::uint16_t kDrives = 20;
  Bus bus;
  test::ListeningObserver observer;
  bus.set_observer(&observer);
  test::ListeningNode controller;
  std::vector<test::ListeningNode> drives(kDrives);
  const NodeHandle master = bus.attach(controller, AcceptanceFilter::all(), 64);
  std::vector<NodeHandle> handles;
  std::vector<hal::CanFrame> rpdos, tpdos;
  for (std::uint16_t i = 0; i < kDrives; ++i) {
    const auto id = static_cast<std::uint16_t>(16 + i);
    const auto low = static_cast<std::uint8_t>(i * 13);
    rpdos.push_back(make_frame(static_cast<std::uint16_t>(0x200 + id), {0x0F, 0x00, low, 0x10, 0x00, 0x00}));
    tpdos.push_back(
        make_frame(static_cast<std::uint16_t>(0x180 + id), {0x37, 0x12, low, 0x10, 0, 0, 0xFF, 0xFF}));
    handles.push_back(bus.attach(drives[i], {0x080, rpdos[i].identifier}, 8));
    drives[i].answer = [&, i](const hal::CanFrame& frame, std::uint64_t time_us) {
      if (frame.identifier != 0x080) return;
      ASSERT_TRUE(bus.queue(handles[i], tpdos[i], time_us + (i == 3 ? 500 : 20 - i)));
    };
  }
  const hal::CanFrame sync = make_frame(0x080, {});
  const hal::CanFrame heartbeat = make_frame(0x700 + 16 + 7, {0x05});
  ASSERT_TRUE(bus.queue(handles[7], heartbeat, 990));
  for (const hal::CanFrame& rpdo : rpdos) ASSERT_TRUE(bus.queue(master, rpdo, 1000));
  ASSERT_TRUE(bus.queue(master, sync, 1000));
  bus.advance_to(10000);

  // By hand: the heartbeat, then the FIFO of the controller without a gap.
  std::vector<test::SeenFrame> expected = {{heartbeat, 990 + length_us(heartbeat)}};
  const auto follow = [&](const hal::CanFrame& frame) {
    expected.push_back({frame, expected.back().time_us + kIntermission_us + length_us(frame)});
  };
  for (const hal::CanFrame& rpdo : rpdos) follow(rpdo);
  follow(sync);
  // The last drive is ready first, one microsecond after SYNC, and the next two by the end of the
  // intermission: of the three that are ready when the bus is idle the lowest identifier wins. Then all
  // others but drive 3 have become ready.
  const std::uint64_t sync_us = expected.back().time_us;
  follow(tpdos[17]);
  std::vector<std::uint16_t> waiting;
  for (std::uint16_t i = 0; i < kDrives; ++i) {
    if (i != 17) waiting.push_back(i);
  }
  while (!waiting.empty()) {
    const std::uint64_t idle_us = expected.back().time_us + kIntermission_us;
    const auto next = std::find_if(waiting.begin(), waiting.end(),
                                   [&](std::uint16_t i) { return i != 3 || idle_us >= sync_us + 500; });
    follow(tpdos[*next]);
    waiting.erase(next);
  }

  ASSERT_EQ(observer.seen.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(observer.seen[i].frame, expected[i].frame) << "frame " << i;
    EXPECT_EQ(observer.seen[i].end_us, expected[i].time_us) << "frame " << i;
    EXPECT_EQ(observer.seen[i].start_us, expected[i].time_us - length_us(expected[i].frame)) << "frame " << i;
  }
  // The figures that a person gets with pencil and paper for the first and the last of each kind.
  EXPECT_EQ(controller.seen.size(), 21u);  // the heartbeat and the answers
  EXPECT_EQ(drives[3].seen.size(), 2u);    // its RPDO and SYNC
  EXPECT_EQ(drives[3].seen[1].time_us, sync_us);
}

TEST(Bus, BehavesTheSameForAnyStepSize) {
  const auto run = [](std::uint64_t step_us) {
    Bus bus;
    test::ListeningNode a, b, all;
    const NodeHandle node_a = bus.attach(a, {0x200}, 16);
    const NodeHandle node_b = bus.attach(b, {0x100}, 16);
    bus.attach(all, AcceptanceFilter::all(), 1);
    a.answer = [&](const hal::CanFrame&, std::uint64_t now_us) {
      (void)bus.queue(node_a, make_frame(0x100, {1, 2, 3}), now_us + 7);
    };
    b.answer = [&](const hal::CanFrame&, std::uint64_t now_us) {
      (void)bus.queue(node_b, make_frame(0x200, {}), now_us);
    };
    (void)bus.queue(node_a, make_frame(0x100, {9}), 3);
    for (std::uint64_t now_us = step_us; now_us <= 21000; now_us += step_us) bus.advance_to(now_us);
    return all.seen;
  };
  const std::vector<test::SeenFrame> expected = run(1);
  EXPECT_GT(expected.size(), 200u);
  EXPECT_EQ(run(1000), expected);
  EXPECT_EQ(run(21000), expected);
}

}  // namespace
}  // namespace koboshi::sim_board
