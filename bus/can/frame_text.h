#pragma once

#include <string>
#include <string_view>

#include "hal/port/can.h"

namespace koboshi::bus {

// An example of a useful frame: it commands the controller to enable the drives.
inline constexpr std::string_view kSampleFrame = "201#010000";

// Parses the notation of cansend and candump: 123#0011AABB, 123#R3. Throws std::invalid_argument.
hal::CanFrame parse_frame(std::string_view text);
std::string frame_text(const hal::CanFrame& frame);

// Numbers on a command line follow one rule. Identifiers, indices, sub-indices and data are hexadecimal, as
// in candump and CiA 301; nodes, values and counts are decimal; 0x means hexadecimal everywhere. Ambiguous
// numbers are refused. Both functions throw std::invalid_argument that names `what`.

// Parses a decimal number, or 0x and hexadecimal digits. Refuses leading zeros, which some read as octal.
std::uint64_t parse_number(std::string_view text, std::string_view what, std::uint64_t most);
// Parses a hexadecimal number, with or without 0x. Without 0x, the number must have exactly `digits` digits,
// as an identifier or an index has, or mean the same in decimal.
std::uint64_t parse_hexadecimal(std::string_view text, std::string_view what, std::uint64_t most,
                                std::size_t digits);

}  // namespace koboshi::bus
