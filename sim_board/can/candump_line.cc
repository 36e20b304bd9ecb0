#include "sim_board/can/candump_line.h"

#include <algorithm>
#include <charconv>
#include <ctime>
#include <span>

namespace koboshi::sim_board {
namespace {

constexpr std::string_view kNotationDigits = "0123456789ABCDEF";
constexpr std::string_view kBlanks = " \t\r";
constexpr std::uint64_t kLogSecond_us = 1'000'000;
constexpr std::size_t kMaxSecondDigits = 13;    // so that microseconds fit in 64 bits
constexpr std::size_t kRelativeDigits = 3;      // to which candump pads relative times
constexpr std::uint32_t kErrorFlag = 1u << 29;  // of an identifier, linux/can.h
constexpr std::uint32_t kExtendedMask = kErrorFlag - 1;

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// Parses text from its beginning; each function returns false if the next part does not match.
class Parser {
 public:
  explicit Parser(std::string_view text) : rest_(text) {}

  bool literal(char expected) {
    if (rest_.empty() || rest_.front() != expected) return false;
    rest_.remove_prefix(1);
    return true;
  }
  // A number of all digits that follow.
  bool decimal(std::size_t min_digits, std::size_t max_digits, std::uint64_t& value) {
    digits_ = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    return digits_ >= min_digits && digits_ <= max_digits && number(digits_, 10, value);
  }
  bool hexadecimal(std::size_t digits, std::uint64_t& value) {
    return hexadecimal_digits() >= digits && number(digits, 16, value);
  }
  std::size_t hexadecimal_digits() const {
    return std::min(rest_.find_first_not_of("0123456789abcdefABCDEF"), rest_.size());
  }
  bool blanks() {
    const std::size_t size = std::min(rest_.find_first_not_of(kBlanks), rest_.size());
    rest_.remove_prefix(size);
    return size > 0;
  }
  std::string_view word() {
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word.size());
    return word;
  }
  std::size_t digits() const { return digits_; }  // of the last decimal number
  bool at_end() const { return rest_.empty(); }

 private:
  bool number(std::size_t digits, int base, std::uint64_t& value) {
    std::from_chars(rest_.data(), rest_.data() + digits, value, base);
    rest_.remove_prefix(digits);
    return true;
  }

  std::string_view rest_;
  std::size_t digits_ = 0;
};

// --- A frame

bool parse_data(Parser& text, std::span<std::uint8_t> data, std::uint8_t& size) {
  while (!text.at_end()) {
    std::uint64_t byte = 0;
    if (size > 0) static_cast<void>(text.literal('.'));
    if (size == data.size() || !text.hexadecimal(2, byte)) return false;
    data[size++] = static_cast<std::uint8_t>(byte);
    // A raw DLC of 9 to 15 of a classic frame, which has 8 bytes.
    if (size == 8 && text.literal('_')) return text.hexadecimal(1, byte) && byte > 8 && text.at_end();
  }
  return true;
}

bool parse_remote(Parser& text, std::uint8_t& size) {
  std::uint64_t value = 0;
  if (text.at_end()) return true;
  if (!text.decimal(1, 1, value) || value > 8) return false;
  size = static_cast<std::uint8_t>(value);
  if (text.literal('_') && (size != 8 || !text.hexadecimal(1, value))) return false;
  return text.at_end();
}

// Remote request or data of a classic frame.
template <typename Frame>
bool parse_content(Parser& text, Frame& frame) {
  frame.remote = text.literal('R') || text.literal('r');
  if (frame.remote) return parse_remote(text, frame.size);
  return parse_data(text, std::span(frame.data).first(8), frame.size);
}

// FLAGS:TYPE:ACCEPTANCE#DATA. The data are not kept.
std::optional<BusFrame> parse_xl(Parser text, std::uint64_t identifier) {
  std::uint64_t ignored = 0;
  if (!text.hexadecimal(2, ignored) || !text.literal(':') || !text.hexadecimal(2, ignored) ||
      !text.literal(':') || !text.hexadecimal(8, ignored) || !text.literal('#')) {
    return std::nullopt;
  }
  return ForeignFrame{.kind = ForeignFrame::Kind::kXl,
                      .identifier = static_cast<std::uint32_t>(identifier & 0x7FF)};
}

// The part of a frame with a 29-bit identifier, of CAN FD or of an error frame behind `identifier#`.
std::optional<BusFrame> parse_foreign(Parser& text, ForeignFrame frame) {
  std::uint64_t flags = 0;
  if (text.literal('#')) {
    if (frame.kind == ForeignFrame::Kind::kError || !text.hexadecimal(1, flags)) return std::nullopt;
    frame.kind = ForeignFrame::Kind::kFd;
    frame.flags = static_cast<std::uint8_t>(flags);
    static_cast<void>(text.literal('.'));
    if (!parse_data(text, frame.data, frame.size) || !is_fd_size(frame.size)) return std::nullopt;
    return frame;
  }
  if (!parse_content(text, frame)) return std::nullopt;
  return frame;
}

std::optional<BusFrame> parse_standard(Parser& text, std::uint16_t identifier) {
  hal::CanFrame frame{.identifier = identifier};
  if (!parse_content(text, frame)) return std::nullopt;
  return frame;
}

// --- A line

// Local date and time, YYYY-MM-DD hh:mm:ss.
bool parse_date(Parser& line, std::uint64_t& seconds) {
  std::uint64_t part[6]{};
  constexpr char kSeparators[] = "-- ::";
  for (std::size_t i = 0; i < std::size(part); ++i) {
    if (!line.decimal(i == 0 ? 4 : 2, i == 0 ? 4 : 2, part[i])) return false;
    if (i + 1 < std::size(part) && !line.literal(kSeparators[i])) return false;
  }
  std::tm time{};
  time.tm_year = static_cast<int>(part[0]) - 1900;
  time.tm_mon = static_cast<int>(part[1]) - 1;
  time.tm_mday = static_cast<int>(part[2]);
  time.tm_hour = static_cast<int>(part[3]);
  time.tm_min = static_cast<int>(part[4]);
  time.tm_sec = static_cast<int>(part[5]);
  time.tm_isdst = -1;
  seconds = static_cast<std::uint64_t>(std::max<std::time_t>(std::mktime(&time), 0));
  return true;
}

// (SECONDS.MICROSECONDS), with nanoseconds, or with a date.
bool parse_time(Parser& line, LogLine& result) {
  if (!line.literal('(')) return false;
  const Parser before = line;
  std::uint64_t seconds = 0;
  std::uint64_t fraction = 0;
  if (!line.decimal(1, kMaxSecondDigits, seconds) || !line.literal('.')) {
    line = before;
    if (!parse_date(line, seconds) || !line.literal('.')) return false;
  } else {
    result.zero_padded = line.digits() == kRelativeDigits;
  }
  if (!line.decimal(6, 9, fraction) || (line.digits() != 6 && line.digits() != 9)) return false;
  if (line.digits() == 9) fraction /= 1000;
  result.logged.time_us = seconds * kLogSecond_us + fraction;
  return line.literal(')');
}

bool parse_frame_line(std::string_view text, LogLine& result) {
  Parser line(text);
  if (!parse_time(line, result) || !line.blanks()) return false;
  result.logged.interface = line.word();
  line.blanks();
  const auto frame = parse_frame_notation(line.word());
  if (!frame) return false;
  result.logged.frame = *frame;
  if (line.at_end()) return true;
  line.blanks();
  result.logged.direction = line.literal('T') ? Direction::kSent : Direction::kReceived;
  return (result.logged.direction == Direction::kSent || line.literal('R')) && line.at_end();
}

// The bytes follow their number in brackets: `can0  123   [2]  00 11`.
bool is_screen_line(std::string_view text) {
  const std::size_t open = text.find(" [");
  const std::size_t close = text.find("] ", open == std::string_view::npos ? text.size() : open);
  const bool ends = open != std::string_view::npos && text.back() == ']' && close == std::string_view::npos;
  if ((close == std::string_view::npos && !ends) || text.substr(0, open).find('#') != std::string_view::npos)
    return false;
  const std::size_t end = ends ? text.size() - 1 : close;
  const std::string_view size = text.substr(open + 2, end - open - 2);
  return !size.empty() && size.size() <= 4 && size.find_first_not_of("0123456789") == std::string_view::npos;
}

bool parse_dropped(std::string_view text, std::uint64_t& frames) {
  constexpr std::string_view kBegin = "DROPCOUNT: dropped ";
  return text.starts_with(kBegin) && Parser(text.substr(kBegin.size())).decimal(1, 10, frames);
}

}  // namespace

std::optional<BusFrame> parse_frame_notation(std::string_view notation) {
  Parser text(notation);
  std::uint64_t identifier = 0;
  const std::size_t digits = text.hexadecimal_digits();
  if (!text.hexadecimal(digits, identifier) || !text.literal('#')) return std::nullopt;
  if (digits == 3 || digits == 5) {
    if (const auto frame = parse_xl(text, identifier)) return frame;
  }
  if (digits == 8) {
    const bool error = (identifier & kErrorFlag) != 0;
    if (identifier > (kErrorFlag | kExtendedMask)) return std::nullopt;
    return parse_foreign(text, {.kind = error ? ForeignFrame::Kind::kError : ForeignFrame::Kind::kExtended,
                                .extended = !error,
                                .identifier = static_cast<std::uint32_t>(identifier & kExtendedMask)});
  }
  if (digits != 3 || identifier > 0x7FF) return std::nullopt;
  Parser rest = text;
  if (rest.literal('#')) return parse_foreign(text, {.identifier = static_cast<std::uint32_t>(identifier)});
  return parse_standard(text, static_cast<std::uint16_t>(identifier));
}

std::string frame_notation(const BusFrame& frame) {
  std::string text;
  const auto put = [&text](std::uint32_t value, int digits) {
    for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) text += kNotationDigits[value >> shift & 0xFu];
  };
  const auto put_content = [&](const auto& content) {
    if (content.remote) {
      text += 'R';
      if (content.size > 0) text += kNotationDigits[content.size];
      return;
    }
    for (std::size_t i = 0; i < content.size; ++i) put(content.data[i], 2);
  };
  if (const auto* standard = std::get_if<hal::CanFrame>(&frame)) {
    put(standard->identifier, 3);
    text += '#';
    put_content(*standard);
    return text;
  }
  const auto& foreign = std::get<ForeignFrame>(frame);
  const bool error = foreign.kind == ForeignFrame::Kind::kError;
  put(foreign.identifier | (error ? kErrorFlag : 0), error || foreign.extended ? 8 : 3);
  text += '#';
  if (foreign.kind == ForeignFrame::Kind::kXl) return text + "...";
  if (foreign.kind == ForeignFrame::Kind::kFd) {
    text += '#';
    put(foreign.flags, 1);
  }
  put_content(foreign);
  return text;
}

LogLine parse_log_line(std::string_view whole) {
  const std::string_view text = trimmed(whole);
  LogLine line;
  if (text.empty() || text.front() == '#' || text.front() == ';' || text.starts_with("//")) {
    line.kind = LineKind::kBlank;
  } else if (parse_frame_line(text, line)) {
    line.kind = LineKind::kFrame;
  } else if (parse_dropped(text, line.dropped)) {
    line.kind = LineKind::kDropped;
  } else if (is_screen_line(text)) {
    line.kind = LineKind::kScreen;
  }
  return line;
}

}  // namespace koboshi::sim_board
