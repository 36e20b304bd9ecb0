#pragma once

#include <cstdint>

#include "hal/port/can.h"

namespace koboshi::sim {

// Lengths on the wire of classic CAN frames with an 11-bit identifier (ISO 11898-1, "Frame formats" and
// "Frame coding"). SOF, identifier, RTR, IDE, r0, DLC, data and CRC sequence are stuffed: five equal bits in
// a row are followed by an opposite one, which counts as the first of the next row. CRC delimiter, ACK slot,
// ACK delimiter and EOF are not. Precondition of all functions: identifier at most 0x7FF, size at most 8. Of
// remote frames the data are ignored.

inline constexpr int kAckDelimiterBits = 1;
inline constexpr int kEndOfFrameBits = 7;
inline constexpr int kUnstuffedTailBits =
    2 + kAckDelimiterBits + kEndOfFrameBits;  // CRC delimiter and ACK slot first
inline constexpr int kIntermissionBits = 3;
inline constexpr int kErrorFlagBits = 6;
inline constexpr int kErrorDelimiterBits = 8;
// An error that one node sees first: the others answer its flag with theirs.
inline constexpr int kErrorFrameBits = 2 * kErrorFlagBits + kErrorDelimiterBits;
// The recessive bits at the end of every transmission: error delimiter, or ACK delimiter and EOF; then
// intermission.
inline constexpr int kRecessiveEndBits = kErrorDelimiterBits + kIntermissionBits;
inline constexpr int kShortestFrameBits = 44;  // no data, without stuff bits
inline constexpr int kLongestFrameBits = 132;  // 8 bytes and 24 stuff bits

// The CRC sequence: polynomial 0x4599 over the unstuffed bits from SOF to the end of the data.
std::uint16_t crc15(const hal::CanFrame& frame);

// How many stuff bits the frame carries.
int stuff_bits(const hal::CanFrame& frame);

// From SOF to the last bit of EOF, stuff bits included; the intermission follows.
int frame_bits(const hal::CanFrame& frame);

// From SOF to the first bit in which the two differ, that one and the stuff bits included. Precondition: the
// frames have the same identifier and RTR bit, and differ in size or data.
int bits_to_difference(const hal::CanFrame& first, const hal::CanFrame& second);

}  // namespace koboshi::sim
