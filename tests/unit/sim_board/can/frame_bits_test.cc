#include "sim_board/can/frame_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "sim_board/can/foreign_frame.h"
#include "tests/unit/sim_board/can/reference_encoder.h"

namespace koboshi::sim_board {
namespace {

hal::CanFrame random_frame(std::mt19937& random) {
  hal::CanFrame frame;
  frame.identifier = static_cast<std::uint16_t>(random() & 0x7FFu);
  frame.size = static_cast<std::uint8_t>(random() % 9);
  frame.remote = random() % 10 == 0;
  // Half of the frames are made of long rows, where stuffing happens.
  const bool rows = random() % 2 == 0;
  constexpr std::array<std::uint8_t, 6> kRows = {0x00, 0xFF, 0x0F, 0xF0, 0x1F, 0xC1};
  for (std::size_t i = 0; i < frame.size && !frame.remote; ++i) {
    frame.data[i] = rows ? kRows[random() % kRows.size()] : static_cast<std::uint8_t>(random());
  }
  return frame;
}

TEST(FrameBits, EqualTheReferenceEncoderOnRandomFrames) {
  constexpr unsigned kSeed = 20081;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    const hal::CanFrame frame = random_frame(random);
    const test::EncodedFrame expected = test::encode(frame);
    ASSERT_EQ(crc15(frame), expected.crc) << "seed " << kSeed << ", frame " << i;
    ASSERT_EQ(stuff_bits(frame), expected.stuff_bits()) << "seed " << kSeed << ", frame " << i;
    ASSERT_EQ(frame_bits(frame), static_cast<int>(expected.wire.size()))
        << "seed " << kSeed << ", frame " << i;
  }
}

// Nothing but zeros enters the CRC, so it is zero too: 34 equal bits, each five of which are followed by a
// stuff bit, which keeps the next five equal.
TEST(FrameBits, EqualAFrameOfZeros) {
  const hal::CanFrame zeros{};
  EXPECT_EQ(crc15(zeros), 0);
  EXPECT_EQ(stuff_bits(zeros), 6);
  EXPECT_EQ(frame_bits(zeros), 50);
}

// SYNC: 0000 1 and 14 zeros enter the CRC. The one sets the register to the polynomial, 0x4599, and 14 shifts
// (4EAB, 58CF, 7407, 2D97, 5B2E, 73C5, 2213, 4426, 4DD5, 5E33, 79FF, 3667, 6CCE, 1C05) leave 001110000000101.
// With stuff bits in parentheses: 0000 1 00000(1) 00000(1) 0000 | 0(1) 0111 00000(1) 00101, where the bar is
// the beginning of the CRC.
TEST(FrameBits, EqualAHandMadeSync) {
  const hal::CanFrame sync{.identifier = 0x080, .size = 0, .remote = false, .data = {}};
  EXPECT_EQ(crc15(sync), 0x1C05);
  EXPECT_EQ(stuff_bits(sync), 4);
  EXPECT_EQ(frame_bits(sync), 48);
}

TEST(FrameBits, IgnoreTheDataOfARemoteFrame) {
  const hal::CanFrame asked{.identifier = 0x701, .size = 8, .remote = true, .data = {}};
  hal::CanFrame with_rest = asked;
  with_rest.data.fill(0xFF);
  EXPECT_EQ(frame_bits(with_rest), frame_bits(asked));
  EXPECT_EQ(frame_bits(asked), static_cast<int>(test::encode(asked).wire.size()));
}

// 39 bits from SOF to DLC, 15 of the CRC and 10 of the tail. Alternating bits need no stuff bits up to the
// control field, whose zeros and CRC cause a few.
TEST(FrameBits, CountThoseOfA29BitIdentifier) {
  ForeignFrame frame{.extended = true, .identifier = 0x0AAAAAAA};
  EXPECT_GE(frame_bits(frame), 64);
  EXPECT_LE(frame_bits(frame), 64 + 5);
  frame.identifier = 0;  // two stuff bits before SRR and IDE, and at least four behind
  EXPECT_GE(frame_bits(frame), 64 + 6);
  const int empty = frame_bits(frame);
  frame.size = 8;
  EXPECT_GE(frame_bits(frame), empty + 64);
  frame.remote = true;
  EXPECT_LT(frame_bits(frame), 64 + 14);
  EXPECT_EQ(frame_bits(ForeignFrame{.kind = ForeignFrame::Kind::kFd}), 0);
}

// The bound of the literature, 8 n + 44 + floor((34 + 8 n - 1) / 4) = 132 for 8 bytes, is one that data reach
// only if the CRC plays along; the constants bracket every frame.
TEST(FrameBits, StayWithinTheirBounds) {
  std::mt19937 random(7);
  for (int i = 0; i < 10000; ++i) {
    const int bits = frame_bits(random_frame(random));
    ASSERT_GE(bits, kShortestFrameBits);
    ASSERT_LE(bits, kMaxFrameBits);
  }
}

TEST(BitsToDifference, CountEveryBitUpToTheFirstDifferentOne) {
  std::mt19937 random(11);
  int compared = 0;
  while (compared < 2000) {
    const hal::CanFrame first = random_frame(random);
    hal::CanFrame second = random_frame(random);
    second.identifier = first.identifier;
    second.remote = first.remote;
    if (first.remote ? first.size == second.size : first == second) continue;
    const auto [a, b] = std::pair(test::encode(first).wire, test::encode(second).wire);
    const auto different = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first;
    ASSERT_EQ(bits_to_difference(first, second), different - a.begin() + 1);
    ++compared;
  }
}

}  // namespace
}  // namespace koboshi::sim_board
