#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/port/can.h"

namespace koboshi::sim {

// The log format of `candump -L`, which canplayer, log2asc, Wireshark and SavvyCAN read, with simulated time:
//   (0000000012.345678) vcan0 210#0F00112233
// A remote frame is `#R`, followed by the requested size unless it is zero.

inline constexpr std::string_view kLogInterface = "vcan0";

// Maximum length of a line: 20 digits of seconds, and an interface name of 15 characters, Linux' maximum.
inline constexpr std::size_t kMaxLogLineBytes = 1 + 20 + 1 + 6 + 2 + 15 + 1 + 4 + 16 + 1;

// Writes the line with its newline and returns its length. Precondition: the interface's name has at most 15
// characters.
std::size_t format_log_line(std::span<char, kMaxLogLineBytes> line, const hal::CanFrame& frame,
                            std::uint64_t time_us, std::string_view interface = kLogInterface);

struct LoggedFrame {
  hal::CanFrame frame;
  std::uint64_t time_us = 0;
  std::string interface;

  friend bool operator==(const LoggedFrame&, const LoggedFrame&) = default;
};

// Reads a log line by line. Strict: a line that is not a classic frame with an 11-bit identifier in the above
// format, or with an earlier time than its predecessor, is an error. Hexadecimal digits may be upper or lower
// case; seconds may have up to 13 digits.
class CandumpReader {
 public:
  // Throws InputError if the file cannot be opened.
  explicit CandumpReader(const std::filesystem::path& file);
  // Returns the next frame, or nothing at the end. Throws InputError.
  std::optional<LoggedFrame> next();

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  std::string line_;
  int line_number_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace koboshi::sim
