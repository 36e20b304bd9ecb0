#include "sim_board/can/candump_log.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cstring>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"

namespace koboshi::sim {
namespace {

constexpr std::uint64_t kMicrosecondsPerSecond = 1'000'000;
constexpr std::uint64_t kMaxPaddedSeconds = 9'999'999'999;  // candump pads to ten digits
constexpr int kMaxSecondDigits = 13;                        // so that microseconds fit in 64 bits
constexpr std::string_view kHexDigits = "0123456789ABCDEF";

// The two digits of each number below base * base.
template <std::size_t kBase>
constexpr auto make_pairs() {
  std::array<std::array<char, 2>, kBase * kBase> pairs{};
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {kHexDigits[i / kBase], kHexDigits[i % kBase]};
  return pairs;
}
constexpr auto kDecimalPairs = make_pairs<10>();
constexpr auto kHexPairs = make_pairs<16>();

char* put_decimal(char* out, std::uint64_t value, int pairs) {
  for (int i = pairs - 1; i >= 0; --i, value /= 100)
    std::memcpy(out + 2 * i, kDecimalPairs[value % 100].data(), 2);
  return out + 2 * pairs;
}

char* put_seconds(char* out, std::uint64_t seconds) {
  if (seconds <= kMaxPaddedSeconds) return put_decimal(out, seconds, 5);
  return std::to_chars(out, out + 20, seconds).ptr;
}

char* put_byte(char* out, std::uint8_t byte) {
  std::memcpy(out, kHexPairs[byte].data(), 2);
  return out + 2;
}

char* put_content(char* out, const hal::CanFrame& frame) {
  if (!frame.remote) {
    for (std::size_t i = 0; i < frame.size; ++i) out = put_byte(out, frame.data[i]);
    return out;
  }
  *out++ = 'R';
  if (frame.size > 0) *out++ = kHexDigits[frame.size];
  return out;
}

// Parses a line from its beginning; each function returns false if the next part does not match.
class LineParser {
 public:
  explicit LineParser(std::string_view line) : rest_(line) {}

  bool literal(char expected) {
    if (rest_.empty() || rest_.front() != expected) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool decimal(std::size_t min_digits, std::size_t max_digits, std::uint64_t& value) {
    const std::size_t digits = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    return digits >= min_digits && digits <= max_digits && number(digits, 10, value);
  }
  bool hexadecimal(std::size_t digits, std::uint64_t& value) {
    if (rest_.size() < digits) return false;
    return rest_.substr(0, digits).find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos &&
           number(digits, 16, value);
  }
  bool word(std::string& value) {
    const std::size_t size = std::min(rest_.find(' '), rest_.size());
    value = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return size > 0;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  bool number(std::size_t digits, int base, std::uint64_t& value) {
    std::from_chars(rest_.data(), rest_.data() + digits, value, base);
    rest_.remove_prefix(digits);
    return true;
  }

  std::string_view rest_;
};

bool parse_content(LineParser& line, hal::CanFrame& frame) {
  std::uint64_t value = 0;
  frame.remote = line.literal('R');
  if (frame.remote) {
    if (line.at_end()) return true;
    if (!line.decimal(1, 1, value) || value > frame.data.size()) return false;
    frame.size = static_cast<std::uint8_t>(value);
    return line.at_end();
  }
  while (!line.at_end()) {
    if (frame.size == frame.data.size() || !line.hexadecimal(2, value)) return false;
    frame.data[frame.size++] = static_cast<std::uint8_t>(value);
  }
  return true;
}

bool parse_line(std::string_view text, LoggedFrame& logged) {
  LineParser line(text);
  std::uint64_t seconds = 0;
  std::uint64_t microseconds = 0;
  std::uint64_t identifier = 0;
  if (!line.literal('(') || !line.decimal(1, kMaxSecondDigits, seconds) || !line.literal('.') ||
      !line.decimal(6, 6, microseconds) || !line.literal(')') || !line.literal(' ')) {
    return false;
  }
  if (!line.word(logged.interface) || !line.literal(' ')) return false;
  if (!line.hexadecimal(3, identifier) || identifier > 0x7FF || !line.literal('#')) return false;
  logged.time_us = seconds * kMicrosecondsPerSecond + microseconds;
  logged.frame.identifier = static_cast<std::uint16_t>(identifier);
  return parse_content(line, logged.frame);
}

}  // namespace

std::size_t format_log_line(std::span<char, kMaxLogLineBytes> line, const hal::CanFrame& frame,
                            std::uint64_t time_us, std::string_view interface) {
  assert(interface.size() <= 15);
  char* out = line.data();
  *out++ = '(';
  out = put_seconds(out, time_us / kMicrosecondsPerSecond);
  *out++ = '.';
  out = put_decimal(out, time_us % kMicrosecondsPerSecond, 3);
  *out++ = ')';
  *out++ = ' ';
  out = std::copy(interface.begin(), interface.end(), out);
  *out++ = ' ';
  *out++ = kHexDigits[frame.identifier >> 8 & 0xFu];
  out = put_byte(out, static_cast<std::uint8_t>(frame.identifier & 0xFFu));
  *out++ = '#';
  out = put_content(out, frame);
  *out++ = '\n';
  return static_cast<std::size_t>(out - line.data());
}

CandumpReader::CandumpReader(const std::filesystem::path& file)
    : file_(file), stream_(file, std::ios::binary) {
  if (!stream_ || std::filesystem::is_directory(file)) {
    throw InputError(file, 0, "no readable file", "a CAN log as `candump -L` writes it");
  }
}

std::optional<LoggedFrame> CandumpReader::next() {
  if (!std::getline(stream_, line_)) {
    if (stream_.bad()) throw InputError(file_, line_number_, "a read error", "a readable file");
    return std::nullopt;
  }
  ++line_number_;
  if (stream_.eof()) throw InputError(file_, line_number_, "a line without end", "whole lines");
  LoggedFrame logged;
  if (!parse_line(line_, logged)) {
    throw InputError(file_, line_number_, one_line(line_),
                     "`(SECONDS.MICROSECONDS) INTERFACE IDENTIFIER#DATA` with a 3-digit identifier");
  }
  if (logged.time_us < last_us_) {
    throw InputError(file_, line_number_, "a time before the previous frame's", "times that do not decrease");
  }
  last_us_ = logged.time_us;
  return logged;
}

}  // namespace koboshi::sim
