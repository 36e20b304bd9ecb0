#pragma once

#include <string>
#include <string_view>

#include "hal/port/can.h"

namespace koboshi::tools {

// One that a person may want to send: it tells the controller to enable the drives.
inline constexpr std::string_view kSampleFrame = "201#010000";

// The notation of cansend and candump: 123#0011AABB, 123#R3. Throws std::invalid_argument for anything else.
hal::CanFrame parse_frame(std::string_view text);
std::string frame_text(const hal::CanFrame& frame);

// Numbers of a command line, by one rule: what candump and CiA 301 write in hexadecimal (identifiers,
// indices, sub-indices, data) is hexadecimal, everything else (nodes, values, counts) decimal; 0x is
// hexadecimal everywhere. What could be read in two ways is refused. Both throw std::invalid_argument that
// names `what`.

// Decimal, or 0x and hexadecimal digits. Refuses leading zeros, which are octal to some.
std::uint64_t parse_number(std::string_view text, std::string_view what, std::uint64_t most);
// Hexadecimal, with or without 0x. With `digits`, 0x may only be left out where just so many digits are
// written, as an identifier or an index has them, or where decimal would mean the same.
std::uint64_t parse_hexadecimal(std::string_view text, std::string_view what, std::uint64_t most,
                                std::size_t digits);

}  // namespace koboshi::tools
