#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim_board/can/foreign_frame.h"

namespace koboshi::sim_board {

// The direction of a frame in the log of `candump -x`.
enum class Direction : std::uint8_t { kUnknown, kReceived, kSent };

struct LoggedFrame {
  BusFrame frame;
  std::uint64_t time_us = 0;
  std::string interface;
  Direction direction = Direction::kUnknown;

  friend bool operator==(const LoggedFrame&, const LoggedFrame&) = default;
};

// The contents of a line.
enum class LineKind : std::uint8_t {
  kFrame,
  kBlank,      // or a comment: a line that begins with #, ; or //
  kDropped,    // DROPCOUNT of `candump -d`: frames that the kernel has dropped
  kScreen,     // candump's format for the screen
  kMalformed,  // anything else
};

struct LogLine {
  LineKind kind = LineKind::kMalformed;
  LoggedFrame logged;         // of kFrame
  bool zero_padded = false;   // of kFrame: seconds of three digits, as in the relative times of -t d and -t z
  std::uint64_t dropped = 0;  // of kDropped
};

// Parses a line of a log of can-utils, without its newline. Accepts all variants that candump, canplayer and
// asc2log write and read: microseconds or nanoseconds, which are cut to microseconds; local date and time
// (-t A); a direction R or T at the end (-x); an aligned interface; dots between bytes; CR and blanks at
// either end.
LogLine parse_log_line(std::string_view line);

// The notation of candump: 123#0011, 18FEF100#R8, 123##10011 (CAN FD), 20000004#... (an error frame).
std::string frame_notation(const BusFrame& frame);
// Parses the notation. Returns nothing for other text.
std::optional<BusFrame> parse_frame_notation(std::string_view text);

}  // namespace koboshi::sim_board
