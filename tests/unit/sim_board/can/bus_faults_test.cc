#include "sim_board/can/bus_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "sim_board/can/babbler.h"
#include "sim_board/can/bus_off_pause.h"
#include "tests/unit/sim_board/can/bus_fixture.h"
#include "tests/unit/sim_board/can/bus_times.h"

namespace koboshi::sim_board {
namespace {

using hal::CanErrorState;
using test::length_us;
using test::make_frame;
using Effect = FrameFault::Effect;

constexpr std::uint64_t kSeed = 3;

// A sender and two receivers that take everything.
struct BusFaultsTest : testing::Test {
  BusFaultsTest() { bus.set_disturbance(&faults); }

  // Sends frames with this identifier, numbered in their first byte, a millisecond apart.
  void send(int count, std::uint16_t identifier = 0x190) {
    for (int i = 0; i < count; ++i) {
      ASSERT_TRUE(bus.queue(from, make_frame(identifier, {static_cast<std::uint8_t>(i)}), bus.now_us()));
      bus.advance_to(bus.now_us() + 1000);
    }
  }
  static std::vector<int> numbers(const test::ListeningNode& node) {
    std::vector<int> numbers;
    for (const test::SeenFrame& seen : node.seen) numbers.push_back(seen.frame.data[0]);
    return numbers;
  }

  Bus bus;
  BusFaults faults{kSeed};
  test::ListeningNode sender, first, second;
  NodeHandle from = bus.attach(sender, AcceptanceFilter::all(), 8);
  NodeHandle to_first = bus.attach(first, AcceptanceFilter::all(), 8);
  NodeHandle to_second = bus.attach(second, AcceptanceFilter::all(), 8);
};

TEST_F(BusFaultsTest, DropAcknowledgedFramesInOneReceiver) {
  faults.add({.effect = Effect::kLost, .node = to_first, .count = 2});
  send(4);
  EXPECT_EQ(numbers(first), (std::vector<int>{2, 3}));
  EXPECT_EQ(numbers(second), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(bus.counters(from).sent, 4u) << "the sender knows nothing of it";
  EXPECT_EQ(bus.status(from).transmit_error_count, 0);
  EXPECT_EQ(bus.usage().error_frames, 0u);
}

// A frame that a controller's transceiver loses is lost before its filter.
TEST_F(BusFaultsTest, DoNotDependOnTheFilters) {
  faults.add({.effect = Effect::kLost, .node = to_first, .count = 2});
  bus.set_filter(to_first, {0x191});
  send(1, 0x190);
  send(3, 0x191);
  EXPECT_EQ(numbers(first), (std::vector<int>{1, 2}));
}

TEST_F(BusFaultsTest, DelayNoFrameAroundTheFilter) {
  faults.add({.effect = Effect::kDelayed, .node = to_first, .count = 2, .delay_us = 100});
  bus.set_filter(to_first, {0x191});
  send(1, 0x190);
  send(2, 0x191);
  ASSERT_EQ(numbers(first), (std::vector<int>{0, 1}));
  EXPECT_EQ(first.seen[0].frame.identifier, 0x191);
}

TEST_F(BusFaultsTest, DropAFrameInAllReceiversOrInNone) {
  faults.add({.effect = Effect::kLost, .share = 0.5});
  send(200);
  EXPECT_EQ(numbers(first), numbers(second));
  EXPECT_NEAR(static_cast<double>(first.seen.size()), 100.0, 30.0) << "seed " << kSeed;
}

TEST_F(BusFaultsTest, SelectOtherFramesWithAnotherSeed) {
  faults.add({.effect = Effect::kLost, .share = 0.5});
  send(50);
  const std::vector<int> once = numbers(first);
  first.seen.clear();
  faults = BusFaults(kSeed);
  faults.add({.effect = Effect::kLost, .share = 0.5});
  send(50);
  EXPECT_EQ(numbers(first), once);
  first.seen.clear();
  faults = BusFaults(kSeed + 1);
  faults.add({.effect = Effect::kLost, .share = 0.5});
  send(50);
  EXPECT_NE(numbers(first), once);
}

TEST_F(BusFaultsTest, AffectOnlyTheirIdentifiersAndTime) {
  faults.add({.effect = Effect::kLost,
              .first_identifier = 0x190,
              .last_identifier = 0x191,
              .from_us = 1000,
              .until_us = 3000});
  send(4);
  EXPECT_EQ(numbers(first), (std::vector<int>{0, 3}));
  first.seen.clear();
  faults.add({.effect = Effect::kLost, .first_identifier = 0x200, .last_identifier = 0x2FF});
  send(1, 0x1FF);
  send(1, 0x200);
  send(1, 0x2FF);
  send(1, 0x300);
  ASSERT_EQ(first.seen.size(), 2u);
  EXPECT_EQ(first.seen[0].frame.identifier, 0x1FF);
  EXPECT_EQ(first.seen[1].frame.identifier, 0x300);
}

TEST_F(BusFaultsTest, CorruptFramesWhichAreThenSentAgain) {
  faults.add({.effect = Effect::kCorrupted, .node = from, .count = 1});
  send(2);
  EXPECT_EQ(numbers(first), (std::vector<int>{0, 1}));
  EXPECT_EQ(bus.usage().error_frames, 1u);
  EXPECT_EQ(bus.status(from).transmit_error_count, 8 - 2);
  EXPECT_EQ(bus.status(to_first).receive_error_count, 0);
  // Another node's frames are sound.
  ASSERT_TRUE(bus.queue(to_first, make_frame(0x200, {}), bus.now_us()));
  bus.advance_to(bus.now_us() + 1000);
  EXPECT_EQ(bus.usage().error_frames, 1u);
}

TEST_F(BusFaultsTest, DriveABrokenTransceiverIntoBusOffAndItsNodeRecoversAfterAPause) {
  faults.add({.effect = Effect::kCorrupted, .node = from, .until_us = 5'000});
  BusOffPause pause;
  ASSERT_TRUE(bus.queue(from, make_frame(0x190, {1}), 0));
  std::vector<std::uint64_t> begun;
  for (std::uint64_t now_us = 1000; now_us <= 110'000; now_us += 1000) {
    bus.advance_to(now_us);
    if (pause.step(bus, from, bus.status(from), now_us)) begun.push_back(now_us);
    if (now_us == 100'000) {
      EXPECT_EQ(bus.status(from).state, CanErrorState::kBusOff);
    }
  }
  // 32 attempts at about 75 us, half of them with eight bits more.
  EXPECT_EQ(begun, std::vector<std::uint64_t>{3000});
  EXPECT_EQ(bus.usage().error_frames, 32u);
  EXPECT_EQ(bus.status(to_first).receive_error_count, 32 - 1);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorActive);
  EXPECT_EQ(numbers(first), std::vector<int>{1});
  // Recovery was asked for 100 ms after it was seen, and takes 128 times 11 bits of an idle bus.
  EXPECT_EQ(first.seen[0].time_us, 103'000 + 1408 + length_us(make_frame(0x190, {1})));
}

TEST_F(BusFaultsTest, DelayFramesToTheirReceivers) {
  faults.add({.effect = Effect::kDelayed, .node = to_first, .delay_us = 2500});
  std::vector<std::uint64_t> sent_us;
  first.answer = [&](const hal::CanFrame&, std::uint64_t time_us) {
    sent_us.push_back(time_us);
    ASSERT_TRUE(bus.queue(to_first, make_frame(0x300, {}), time_us));
  };
  send(1);
  bus.advance_to(10'000);
  const std::uint64_t end_us = length_us(make_frame(0x190, {0}));
  ASSERT_EQ(first.seen.size(), 1u);
  EXPECT_EQ(first.seen[0].time_us, end_us + 2500);
  ASSERT_EQ(second.seen.size(), 2u);
  EXPECT_EQ(second.seen[0].time_us, end_us);
  EXPECT_EQ(second.seen[1].time_us, end_us + 2500 + length_us(make_frame(0x300, {})))
      << "the answer leaves at the very time";
}

TEST_F(BusFaultsTest, DeliverDelayedFramesWhileOthersAreOnTheWire) {
  faults.add(
      {.effect = Effect::kDelayed, .first_identifier = 0x080, .last_identifier = 0x080, .delay_us = 60});
  ASSERT_TRUE(bus.queue(from, make_frame(0x080, {}), 0));
  ASSERT_TRUE(bus.queue(from, make_frame(0x190, {1, 2, 3, 4, 5, 6, 7, 8}), 0));
  bus.advance_to(1000);
  ASSERT_EQ(first.seen.size(), 2u);
  EXPECT_EQ(first.seen[0].frame.identifier, 0x080);
  EXPECT_EQ(first.seen[0].time_us, length_us(make_frame(0x080, {})) + 60);
  EXPECT_GT(first.seen[1].time_us, first.seen[0].time_us);
}

TEST_F(BusFaultsTest, DiscardDelayedFramesOfAReceiverThatLosesPower) {
  faults.add({.effect = Effect::kDelayed, .delay_us = 5000});
  send(1);
  bus.power_off(to_first);
  bus.power_on(to_first);
  bus.advance_to(10'000);
  EXPECT_TRUE(first.seen.empty());
  EXPECT_EQ(second.seen.size(), 1u);
}

TEST_F(BusFaultsTest, DoubleFramesWhoseSenderMissesTheLastBit) {
  faults.add({.effect = Effect::kDoubled, .count = 1});
  const hal::CanFrame frame = make_frame(0x190, {0});
  send(2);
  EXPECT_EQ(numbers(first), (std::vector<int>{0, 0, 1}));
  EXPECT_EQ(numbers(second), (std::vector<int>{0, 0, 1}));
  // Between the two: flag of six bits and one of the overload flag's, delimiter, intermission.
  EXPECT_EQ(first.seen[0].time_us, length_us(frame));
  EXPECT_EQ(first.seen[1].time_us, 2 * length_us(frame) + 6 + 1 + 8 + kIntermission_us);
  EXPECT_EQ(bus.status(from).transmit_error_count, 8 - 2);
  EXPECT_EQ(bus.status(to_first).receive_error_count, 0) << "an overload is no error";
  EXPECT_EQ(bus.counters(from).sent, 2u);
  EXPECT_EQ(bus.usage().frames, 3u);
  EXPECT_EQ(bus.usage().error_frames, 1u);
  EXPECT_EQ(bus.usage().busy_us,
            2 * length_us(frame) + 15 + length_us(make_frame(0x190, {1})) + 3 * kIntermission_us);
}

TEST_F(BusFaultsTest, DoubleEveryFrameOnceOnly) {
  faults.add({.effect = Effect::kDoubled});
  send(3);
  EXPECT_EQ(numbers(first), (std::vector<int>{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(bus.status(from).transmit_error_count, 3 * (8 - 1));
}

TEST_F(BusFaultsTest, LeaveFramesOfAnUnheardNodeUnacknowledged) {
  faults.add({.effect = Effect::kDoubled});
  bus.power_off(to_first);
  bus.power_off(to_second);
  send(8);
  EXPECT_EQ(bus.usage().frames, 0u);
  EXPECT_EQ(bus.status(from).state, CanErrorState::kErrorPassive);
  EXPECT_EQ(bus.status(from).transmit_error_count, 128);
}

// --- Babbling nodes

TEST_F(BusFaultsTest, BabbleAtFullBusLoad) {
  Babbler babbler(bus, {.frame = make_frame(0x010, {1, 2}), .from_us = 1500, .until_us = 4000});
  const std::uint64_t slot_us = length_us(make_frame(0x010, {1, 2})) + kIntermission_us;
  for (std::uint64_t now_us = 0; now_us <= 6000; now_us += 1000) {
    if (now_us == 3000) {
      ASSERT_TRUE(bus.queue(from, make_frame(0x190, {9}), 2000));
    }
    babbler.advance(now_us);
    bus.advance_to(now_us);
  }
  const auto babbled = [&](std::uint64_t from_us, std::uint64_t until_us) {
    return std::count_if(second.seen.begin(), second.seen.end(), [&](const test::SeenFrame& seen) {
      return seen.frame.identifier == 0x010 && seen.time_us >= from_us && seen.time_us < until_us;
    });
  };
  EXPECT_EQ(second.seen.front().time_us, 1500 + length_us(make_frame(0x010, {1, 2})));
  EXPECT_EQ(babbled(1500, 4000), static_cast<std::ptrdiff_t>(2500 / slot_us));
  EXPECT_EQ(babbled(4000, 7000), 0);
  EXPECT_EQ(second.seen.back().frame.identifier, 0x190) << "who is of lower priority waits for its end";
}

TEST_F(BusFaultsTest, BabbleAtARate) {
  Babbler babbler(bus, {.frame = make_frame(0x010, {}), .interval_us = 400, .until_us = 2000});
  for (std::uint64_t now_us = 1000; now_us <= 4000; now_us += 1000) {
    babbler.advance(now_us);
    bus.advance_to(now_us);
  }
  ASSERT_EQ(first.seen.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(first.seen[i].time_us, 400 * i + length_us(make_frame(0x010, {})));
}

TEST_F(BusFaultsTest, BabbleWithTheIdentifierOfAnotherNodeCollides) {
  Babbler babbler(bus, {.frame = make_frame(0x190, {0}), .interval_us = 1000});
  for (std::uint64_t now_us = 1000; now_us <= 5000; now_us += 1000) {
    ASSERT_TRUE(bus.queue(from, make_frame(0x190, {1}), now_us - 1000));
    babbler.advance(now_us);
    bus.advance_to(now_us);
  }
  EXPECT_GT(bus.usage().collisions, 0u);
  EXPECT_GT(bus.status(from).transmit_error_count, 0);
}

// With a frame on the wire, one that comes late, and a node that comes back from bus-off.
TEST_F(BusFaultsTest, ContinueOnARestoredBus) {
  faults.add({.effect = Effect::kCorrupted, .node = from, .share = 0.3});
  faults.add({.effect = Effect::kDelayed, .node = to_first, .share = 0.5, .delay_us = 700});
  faults.add({.effect = Effect::kDoubled, .share = 0.2});
  Babbler babbler(bus, {.frame = make_frame(0x010, {}), .interval_us = 300, .from_us = 5000});
  const auto go_on = [&] {
    first.seen.clear();
    second.seen.clear();
    for (int i = 0; i < 40; ++i) {
      static_cast<void>(
          bus.queue(from, make_frame(0x190, {static_cast<std::uint8_t>(i)}), bus.now_us() + 50));
      static_cast<void>(bus.queue(to_second, make_frame(0x190, {200}), bus.now_us() + 50));
      babbler.advance(bus.now_us() + 217);
      bus.advance_to(bus.now_us() + 217);
      bus.recover(from);
    }
    return std::tuple(first.seen, second.seen, bus.usage().busy_us, bus.counters(from).sent,
                      bus.status(from).transmit_error_count);
  };
  for (int run = 0; run < 5; ++run) {
    const SavedState saved = StateArchive::save(bus, faults, babbler);
    const auto before = go_on();
    bus.power_off(from);
    bus.set_dominant(true);
    bus.advance_to(bus.now_us() + 1'000 + 100 * static_cast<std::uint64_t>(run));
    StateArchive::restore(saved, bus, faults, babbler);
    EXPECT_EQ(go_on(), before) << "run " << run;
  }
}

TEST_F(BusFaultsTest, CannotBeRestoredWithAnotherNodeOnTheBus) {
  const SavedState saved = StateArchive::save(bus);
  test::ListeningNode late;
  bus.attach(late, {}, 1);
  EXPECT_THROW(StateArchive::restore(saved, bus), std::logic_error);
}

}  // namespace
}  // namespace koboshi::sim_board
