#pragma once

#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <span>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/pdo.h"
#include "firmware/canopen/sdo/protocol.h"
#include "hal/port/can.h"

// Generates frames for fuzzing a node: noise, valid messages of its services, and such messages with an
// error.
namespace koboshi::test {

// xorshift64*, a generator that gives the same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint32_t next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return static_cast<std::uint32_t>((state_ * 0x2545F4914F6CDD1DULL) >> 32);
  }
  std::uint32_t below(std::uint32_t limit) { return next() % limit; }
  const auto& one_of(const auto& values) {
    return values[below(static_cast<std::uint32_t>(std::size(values)))];
  }

 private:
  std::uint64_t state_;
};

// Number of frames of a fuzz test: a fraction of a second's worth, or KOBOSHI_FUZZ_FRAMES.
inline std::uint64_t frames_to_survive() {
  const char* const wanted = std::getenv("KOBOSHI_FUZZ_FRAMES");
  return wanted == nullptr ? 100'000 : std::strtoull(wanted, nullptr, 10);
}

inline hal::CanFrame noise_frame(Random& random) {
  hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(random.below(0x800)),
                      .size = static_cast<std::uint8_t>(random.below(9)),
                      .remote = random.below(8) == 0};
  for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random.next());
  return frame;
}

// Returns the frame with another size or with one bit of its identifier or data flipped.
inline hal::CanFrame mutated(hal::CanFrame frame, Random& random) {
  switch (random.below(3)) {
    case 0:
      frame.size = static_cast<std::uint8_t>(random.below(9));
      break;
    case 1:
      frame.identifier = static_cast<std::uint16_t>(frame.identifier ^ 1u << random.below(11));
      break;
    default:
      frame.data[random.below(8)] ^= static_cast<std::uint8_t>(1u << random.below(8));
  }
  return frame;
}

// Returns an SDO request, in any order, for the objects in `rows` and in the communication profile.
inline hal::CanFrame sdo_request(std::uint16_t identifier, std::span<const canopen::Entry> rows,
                                 Random& random) {
  static constexpr std::uint8_t kCommands[] = {0x23, 0x2B, 0x2F, 0x2F, 0x40, 0x40, 0x21, 0x00, 0x10,
                                               0x01, 0x60, 0x70, 0x80, 0xA0, 0xA1, 0xA2, 0xA3, 0xA4,
                                               0xC0, 0xC1, 0xC2, 0xC6, 1,    2,    3,    0x82};
  static constexpr std::uint16_t kCommunication[] = {
      0x1000, 0x1001, 0x1003, 0x1005, 0x1006, 0x1008, 0x1010, 0x1011, 0x1014, 0x1015, 0x1016,
      0x1017, 0x1018, 0x1019, 0x1029, 0x1200, 0x1201, 0x1400, 0x1401, 0x1402, 0x1600, 0x1601,
      0x1602, 0x1800, 0x1801, 0x1802, 0x1807, 0x1A00, 0x1A01, 0x1A02, 0x1A07};
  const canopen::Entry& row = random.one_of(rows);
  canopen::ObjectAddress address{row.index,
                                 static_cast<std::uint8_t>(row.subindex + random.below(row.count + 1u))};
  std::uint32_t value = random.next() >> random.below(32);
  if (random.below(2) == 0)
    address = {random.one_of(kCommunication), static_cast<std::uint8_t>(random.below(7))};
  if (random.below(4) == 0) value = canopen::mapping(row.index, row.subindex, 8 << random.below(3));
  if (random.below(32) == 0) value = random.below(2) == 0 ? 0x6576'6173 : 0x6461'6F6C;  // "save", "load"
  return {.identifier = identifier,
          .size = 8,
          .data = canopen::sdo::message(random.one_of(kCommands), address, value)};
}

}  // namespace koboshi::test
