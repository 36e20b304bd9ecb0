#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "hal/port/can.h"

namespace koboshi::sim_board {

// A frame that a real bus may carry, but no CANopen node of CiA 301 sends: with a 29-bit identifier, in the
// format of CAN FD or CAN XL, or an error frame, by which Linux reports an error of the bus.
struct ForeignFrame {
  enum class Kind : std::uint8_t { kExtended, kFd, kXl, kError };
  static constexpr std::size_t kMaxBytes = 64;  // of CAN FD

  Kind kind = Kind::kExtended;
  bool extended = false;  // of CAN FD: a 29-bit identifier
  bool remote = false;
  std::uint8_t flags = 0;        // of CAN FD: 1 bit rate switch, 2 error state indicator (linux/can.h)
  std::uint8_t size = 0;         // bytes of data; for a remote frame, the requested size; 0 for CAN XL
  std::uint32_t identifier = 0;  // 11 or 29 bits; for an error frame, its classes (linux/can/error.h)
  std::array<std::uint8_t, kMaxBytes> data{};

  friend bool operator==(const ForeignFrame&, const ForeignFrame&) = default;
};

// Returns whether a frame of CAN FD can have this number of bytes: its length code has four bits (ISO
// 11898-1).
constexpr bool is_fd_size(std::size_t bytes) {
  return bytes <= 8 || (bytes <= 24 && bytes % 4 == 0) || bytes == 32 || bytes == 48 || bytes == 64;
}

// Any frame on a bus.
using BusFrame = std::variant<hal::CanFrame, ForeignFrame>;

// Returns the bits of a classic frame with a 29-bit identifier from SOF to the last bit of EOF, including
// stuff bits, as frame_bits.h does for others; 0 for any other foreign frame, whose length depends on the bit
// rates of CAN FD, or which is none on the bus.
int frame_bits(const ForeignFrame& frame);

}  // namespace koboshi::sim_board
