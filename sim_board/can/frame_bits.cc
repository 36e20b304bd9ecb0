#include "sim_board/can/frame_bits.h"

#include <array>
#include <cassert>

#include "sim_board/can/foreign_frame.h"

namespace koboshi::sim_board {
namespace {

constexpr int kHeaderBits = 19;  // SOF to DLC
constexpr int kCrcBits = 15;

// The unstuffed bits from SOF to DLC, the last in bit 0. SOF, IDE and r0 are dominant, that is zero.
std::uint32_t header(const hal::CanFrame& frame) {
  assert(frame.identifier <= 0x7FF && frame.size <= frame.data.size());
  return static_cast<std::uint32_t>(frame.identifier << 7 | (frame.remote ? 1 << 6 : 0) | frame.size);
}

int data_bytes(const hal::CanFrame& frame) { return frame.remote ? 0 : frame.size; }

// State that determines the next stuff bit: bit 2 is the last bit, bits 0..1 are its run length (1..4) minus
// one.
using StuffState = std::uint8_t;

struct StuffStep {
  StuffState state;
  bool stuffed;
};

constexpr StuffStep push_bit(StuffState state, unsigned bit) {
  const unsigned last = state >> 2;
  const unsigned row = (state & 3u) + 1;
  if (bit != last) return {static_cast<StuffState>(bit << 2), false};
  if (row < 4) return {static_cast<StuffState>(bit << 2 | row), false};
  return {static_cast<StuffState>((bit ^ 1u) << 2), true};
}

// Per state and byte: the state after the byte in bits 0..2, and the number of its stuff bits above.
using StuffTable = std::array<std::array<std::uint8_t, 256>, 8>;

constexpr StuffTable make_stuff_table() {
  StuffTable table{};
  for (unsigned state = 0; state < table.size(); ++state) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      StuffState current = static_cast<StuffState>(state);
      unsigned count = 0;
      for (int bit = 7; bit >= 0; --bit) {
        const StuffStep step = push_bit(current, byte >> bit & 1u);
        current = step.state;
        count += step.stuffed ? 1 : 0;
      }
      table[state][byte] = static_cast<std::uint8_t>(count << 3 | current);
    }
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned crc = byte << (kCrcBits - 8);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x4000u) != 0 ? crc << 1 ^ 0x4599u : crc << 1;
    table[byte] = static_cast<std::uint16_t>(crc & 0x7FFFu);
  }
  return table;
}

constexpr StuffTable kStuffTable = make_stuff_table();
constexpr std::array<std::uint16_t, 256> kCrcTable = make_crc_table();

class StuffCounter {
 public:
  void push_byte(unsigned byte) {
    const std::uint8_t entry = kStuffTable[state_][byte & 0xFFu];
    count_ += entry >> 3;
    state_ = entry & 7u;
  }
  int count() const { return count_; }

 private:
  StuffState state_ = 0;
  int count_ = 0;
};

unsigned push_crc(unsigned crc, unsigned byte) {
  return (crc << 8 ^ kCrcTable[(crc >> 7 ^ byte) & 0xFFu]) & 0x7FFFu;
}

unsigned bit_at(const hal::CanFrame& frame, int index) {
  if (index < kHeaderBits) return header(frame) >> (kHeaderBits - 1 - index) & 1u;
  const int in_data = index - kHeaderBits;
  return static_cast<unsigned>(frame.data[static_cast<std::size_t>(in_data / 8)]) >> (7 - in_data % 8) & 1u;
}

}  // namespace

std::uint16_t crc15(const hal::CanFrame& frame) {
  // The register starts at zero, so the five zeros that pad the header to three bytes have no effect.
  const std::uint32_t bits = header(frame);
  unsigned crc = push_crc(push_crc(push_crc(0, bits >> 16), bits >> 8 & 0xFFu), bits & 0xFFu);
  for (int i = 0; i < data_bytes(frame); ++i) crc = push_crc(crc, frame.data[static_cast<std::size_t>(i)]);
  return static_cast<std::uint16_t>(crc);
}

int stuff_bits(const hal::CanFrame& frame) {
  // Pads to whole bytes with bits that cannot cause a stuff bit: alternating bits before SOF, and after the
  // CRC the opposite of its last bit.
  const std::uint32_t bits = 0b10101u << kHeaderBits | header(frame);
  const unsigned crc = crc15(frame);
  StuffCounter counter;
  counter.push_byte(bits >> 16);
  counter.push_byte(bits >> 8);
  counter.push_byte(bits);
  for (int i = 0; i < data_bytes(frame); ++i) counter.push_byte(frame.data[static_cast<std::size_t>(i)]);
  counter.push_byte(crc >> 7);
  counter.push_byte(crc << 1 | (~crc & 1u));
  return counter.count();
}

int frame_bits(const hal::CanFrame& frame) {
  return kHeaderBits + 8 * data_bytes(frame) + kCrcBits + stuff_bits(frame) + kUnstuffedTailBits;
}

int frame_bits(const ForeignFrame& frame) {
  if (frame.kind != ForeignFrame::Kind::kExtended) return 0;
  StuffState state = 0b100;  // the bus was recessive before SOF
  unsigned crc = 0;
  int bits = 0;
  const auto push = [&](std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) {
      const auto bit = static_cast<unsigned>(value >> i & 1u);
      const bool feedback = ((crc >> (kCrcBits - 1) ^ bit) & 1u) != 0;
      crc = (crc << 1 & 0x7FFFu) ^ (feedback ? 0x4599u : 0u);
      const StuffStep step = push_bit(state, bit);
      state = step.state;
      bits += step.stuffed ? 2 : 1;
    }
  };
  push(0, 1);                            // SOF
  push(frame.identifier >> 18, 11);      // base identifier
  push(0b11, 2);                         // SRR and IDE are recessive
  push(frame.identifier & 0x3FFFF, 18);  // identifier extension
  push(frame.remote ? 0b100 : 0, 3);     // RTR, r1, r0
  push(frame.size, 4);
  for (std::size_t i = 0; !frame.remote && i < frame.size; ++i) push(frame.data[i], 8);
  push(crc, kCrcBits);
  return bits + kUnstuffedTailBits;
}

int bits_to_difference(const hal::CanFrame& first, const hal::CanFrame& second) {
  const int end = kHeaderBits + 8 * data_bytes(first);
  StuffState state = 0b100;  // the bus was recessive before SOF
  int bits = 1;
  for (int i = 0; i < end && bit_at(first, i) == bit_at(second, i); ++i) {
    const StuffStep step = push_bit(state, bit_at(first, i));
    state = step.state;
    bits += step.stuffed ? 2 : 1;
  }
  return bits;
}

}  // namespace koboshi::sim_board
