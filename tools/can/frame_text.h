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

// A number as a person writes it, decimal or 0x..., within these bounds. Throws std::invalid_argument that
// names `what`.
std::uint64_t parse_number(std::string_view text, std::string_view what, std::uint64_t most);

}  // namespace koboshi::tools
