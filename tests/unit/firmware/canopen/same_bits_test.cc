// What a node sends and does between random frames must be the same everywhere
// (tests/unit/firmware/fixed/digest.h).

#include <gtest/gtest.h>

#include "tests/support/random_frames.h"
#include "tests/unit/firmware/canopen/test_node.h"
#include "tests/unit/firmware/fixed/digest.h"

namespace koboshi::canopen {
namespace {

// A download of an object with its size, to a value that is often within its range.
hal::CanFrame valid_download(test::Random& random) {
  struct Row {
    ObjectAddress address;
    std::uint8_t size;
    std::uint32_t value;
  };
  static constexpr Row kRows[] = {
      {{0x2000, 1}, 4, 77},          {{0x2000, 3}, 4, 0x8000'0001}, {{0x2001, 0}, 1, 5},
      {{0x2002, 0}, 1, 1},           {{0x6040, 0}, 2, 0xABCD},      {{0x6060, 0}, 1, 9},
      {{0x607A, 0}, 4, 999},         {{0x607A, 0}, 4, 0xFFFF'FC19}, {{0x1005, 0}, 4, 0x4000'0080},
      {{0x1006, 0}, 4, 5'000},       {{0x1014, 0}, 4, 0x90},        {{0x1015, 0}, 2, 300},
      {{0x1016, 1}, 4, 0x0001'0040}, {{0x1016, 2}, 4, 0x0002'0030}, {{0x1017, 0}, 2, 20},
      {{0x1019, 0}, 1, 7},           {{0x1029, 1}, 1, 1},           {{0x1003, 0}, 1, 0},
      {{0x1400, 1}, 4, 0x8000'0210}, {{0x1400, 1}, 4, 0x210},       {{0x1400, 2}, 1, 254},
      {{0x1401, 5}, 2, 40},          {{0x1600, 0}, 1, 0},           {{0x1600, 1}, 4, mapping(0x6060, 0, 8)},
      {{0x1600, 0}, 1, 1},           {{0x1800, 1}, 4, 0x8000'0190}, {{0x1800, 1}, 4, 0x190},
      {{0x1800, 2}, 1, 3},           {{0x1800, 3}, 2, 50},          {{0x1800, 5}, 2, 30},
      {{0x1801, 6}, 1, 4},           {{0x1A00, 0}, 1, 0},           {{0x1A00, 1}, 4, mapping(0x6077, 0, 16)},
      {{0x1A00, 0}, 1, 1},           {{0x1010, 1}, 4, 0x6576'6173}, {{0x1011, 1}, 4, 0x6461'6F6C}};
  const Row& row = random.one_of(kRows);
  const std::uint32_t value = row.value + (random.below(4) == 0 ? random.below(3) : 0);
  const auto command = static_cast<std::uint8_t>(0x23 | (4 - row.size) << 2);
  return {.identifier = 0x610, .size = 8, .data = sdo::message(command, row.address, value)};
}

// A frame that the node of id 0x10 serves, or a mutated one.
hal::CanFrame likely_frame(test::Random& random) {
  hal::CanFrame frame;
  switch (random.below(8)) {
    case 0:
      frame = valid_download(random);
      break;
    case 1:
    case 2:
      frame = test::sdo_request(0x610, kTestRows, random);
      break;
    case 3:
      frame = can_frame(0x080, {});
      if (random.below(2) == 0) frame = can_frame(0x080, {random.below(241)});
      break;
    case 4: {
      frame = test::noise_frame(random);
      static constexpr std::uint16_t kReceived[] = {0x210, 0x310, 0x701, 0x702, 0x081, 0x082, 0x100, 0x710};
      frame.identifier = random.one_of(kReceived);
      frame.remote = false;
      break;
    }
    case 5: {  // LSS: each command, most often with this device's identity
      static constexpr unsigned kCommands[] = {4, 17, 19, 21, 23, 64, 65, 66, 67, 76, 90, 91, 92, 93, 94, 81};
      const unsigned command = random.one_of(kCommands);
      frame = can_frame(0x7E5, {command, 0, 0, 0, 0, 0, 0, 0});
      const std::uint32_t fields[] = {0x11223344, 0x55, 0x00010002, 0xCAFE};
      const std::uint32_t field = command >= 64 && command <= 67 ? fields[command - 64] : random.below(130);
      store_u32(&frame.data[1], field);
      if (random.below(16) == 0) frame.data[1] ^= 1;
      break;
    }
    case 6: {
      static constexpr unsigned kNmt[] = {1, 1, 1, 1, 2, 0x80, 0x80, 0x81, 0x82, 3};
      frame = can_frame(0x000, {random.one_of(kNmt), random.below(3) * 0x10});
      break;
    }
    default:
      frame = test::noise_frame(random);
  }
  return random.below(10) == 0 ? test::mutated(frame, random) : frame;
}

std::uint64_t node_digest(const NodeDescription& description, std::uint64_t seed) {
  TestNode node(0x10, description);
  node.bytes.bytes = counted_bytes(300);
  node.make_operational();
  test::Random random(seed);
  test::Digest digest;
  std::uint64_t now_us = 0;
  std::size_t sent = 0;
  for (int i = 0; i < 6'000; ++i) {
    // Now and then a node without a stored id, or with a full queue, starts anew.
    if (i % 500 == 499) node.start(0x10, now_us);
    if (i % 500 == 499) node.node.command(NmtCommand::kStart, now_us);
    node.sink.room = random.below(20) == 0 ? 0 : 1'000'000;
    node.verdict = random.below(30) == 0 ? AbortCode::kDeviceState : AbortCode::kNone;
    node.takes_rpdos = random.below(10) != 0;
    node.next_statusword = static_cast<std::uint16_t>(random.below(3));
    node.values.position = static_cast<std::int32_t>(random.below(4));
    node.values.torque = static_cast<std::int16_t>(random.below(2));
    if (random.below(40) == 0) {
      const auto code = static_cast<std::uint16_t>(0x1000 * (1 + random.below(3)));
      if (random.below(2) == 0) {
        node.node.raise_error(code, static_cast<std::uint8_t>(random.below(256)));
      } else {
        node.node.clear_error(code);
      }
    }
    node.hear(likely_frame(random), now_us);
    now_us += 1'000ull * random.below(random.below(8) == 0 ? 200 : 4);
    node.node.process(now_us);
    for (const hal::CanFrame& frame : node.sink.take()) {
      ++sent;
      digest.add(frame.identifier);
      digest.add(frame.size);
      for (std::size_t byte = 0; byte < frame.size; ++byte) digest.add(frame.data[byte]);
    }
    digest.add(node.values.controlword);
    digest.add(node.values.target);
    digest.add(node.values.mode);
    digest.add(node.values.gains[2]);
    digest.add(node.bytes.bytes.size());
    digest.add(node.syncs);
    for (const std::size_t count :
         {node.written.size(), node.resets.size(), node.stored.size(), node.restored.size(),
          node.stored_node_ids.size(), node.node_ids.size(), node.times.size(), node.states.size(),
          node.rpdos.size(), node.silent_rpdos.size(), node.heartbeats.size(), node.emergencies.size(),
          node.impostors.size()})
      digest.add(count);
  }
  EXPECT_GT(sent, 1'000u);
  EXPECT_GT(node.written.size(), 20u);
  EXPECT_GT(node.rpdos.size(), 20u);
  return digest.value();
}

TEST(SameBits, OfAControllerBetweenFrames) {
  EXPECT_EQ(node_digest(kTestDescription, 4'301), 0x21E5'9364'D25C'8CC7u);
}

TEST(SameBits, OfADeviceBetweenFrames) { EXPECT_EQ(node_digest(kTestDevice, 4'301), 0x269E'EB40'CCCF'4585u); }

}  // namespace
}  // namespace koboshi::canopen
