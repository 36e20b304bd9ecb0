#pragma once

#include <cstdint>

#include "hal/port/can.h"

namespace koboshi::sim_board {

// Lengths of classic CAN frames with an 11-bit identifier (ISO 11898-1, "Frame formats" and "Frame coding").
// SOF, identifier, RTR, IDE, r0, DLC, data and CRC sequence are stuffed: after five equal bits follows an
// opposite one, which counts as the first of the next run. CRC delimiter, ACK slot, ACK delimiter and EOF are
// not stuffed. Precondition of all functions: identifier at most 0x7FF, size at most 8. The data of remote
// frames are ignored.

inline constexpr int kAckDelimiterBits = 1;
inline constexpr int kEndOfFrameBits = 7;
inline constexpr int kUnstuffedTailBits =
    2 + kAckDelimiterBits + kEndOfFrameBits;  // CRC delimiter and ACK slot first
inline constexpr int kIntermissionBits = 3;
inline constexpr int kErrorFlagBits = 6;
inline constexpr int kErrorDelimiterBits = 8;
// An error that one node detects first: the others answer its flag with theirs.
inline constexpr int kErrorFrameBits = 2 * kErrorFlagBits + kErrorDelimiterBits;
// Recessive bits at the end of every transmission: error delimiter, or ACK delimiter and EOF, followed by the
// intermission.
inline constexpr int kRecessiveEndBits = kErrorDelimiterBits + kIntermissionBits;
inline constexpr int kShortestFrameBits = 44;  // no data, without stuff bits
inline constexpr int kMaxFrameBits = 132;      // 8 bytes and 24 stuff bits

// Returns the CRC sequence: polynomial 0x4599 over the unstuffed bits from SOF to the end of the data.
std::uint16_t crc15(const hal::CanFrame& frame);

// Returns the number of stuff bits.
int stuff_bits(const hal::CanFrame& frame);

// Returns the bits from SOF to the last bit of EOF, including stuff bits, without the intermission.
int frame_bits(const hal::CanFrame& frame);

// Returns the bits from SOF to the first bit in which the frames differ, including that bit and the stuff
// bits. Precondition: the frames have the same identifier and RTR bit, and differ in size or data.
int bits_to_difference(const hal::CanFrame& first, const hal::CanFrame& second);

}  // namespace koboshi::sim_board
