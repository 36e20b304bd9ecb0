#include "sim_board/can/candump_log.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cstring>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::sim_board {
namespace {

constexpr std::uint64_t kMicrosecondsPerSecond = 1'000'000;
constexpr std::uint64_t kMaxPaddedSeconds = 9'999'999'999;  // candump pads to ten digits
// Frames of several interfaces in disorder by less are no sign of a clock that was set.
constexpr std::uint64_t kMaxDisorder_us = kMicrosecondsPerSecond;
constexpr const char* kLog = "a CAN log";
constexpr const char* kLine = "`(SECONDS.MICROSECONDS) INTERFACE IDENTIFIER#DATA`, as `candump -L` writes it";
constexpr const char* kFdSizes = "; CAN FD has 0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes";
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

// (SECONDS.MICROSECONDS) and a blank.
char* put_time(char* out, std::uint64_t time_us) {
  *out++ = '(';
  out = put_seconds(out, time_us / kMicrosecondsPerSecond);
  *out++ = '.';
  out = put_decimal(out, time_us % kMicrosecondsPerSecond, 3);
  *out++ = ')';
  *out++ = ' ';
  return out;
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

}  // namespace

std::size_t format_log_line(std::span<char, kMaxLogLineBytes> line, const hal::CanFrame& frame,
                            std::uint64_t time_us, std::string_view interface) {
  assert(interface.size() <= 15);
  char* out = line.data();
  out = put_time(out, time_us);
  out = std::copy(interface.begin(), interface.end(), out);
  *out++ = ' ';
  *out++ = kHexDigits[frame.identifier >> 8 & 0xFu];
  out = put_byte(out, static_cast<std::uint8_t>(frame.identifier & 0xFFu));
  *out++ = '#';
  out = put_content(out, frame);
  *out++ = '\n';
  return static_cast<std::size_t>(out - line.data());
}

std::string log_line(const LoggedFrame& logged) {
  std::array<char, kMaxLogLineBytes> time;
  char* const end = put_time(time.data(), logged.time_us);
  const char* const direction = logged.direction == Direction::kSent       ? " T\n"
                                : logged.direction == Direction::kReceived ? " R\n"
                                                                           : "\n";
  return std::string(time.data(), end) + logged.interface + " " + frame_notation(logged.frame) + direction;
}

CandumpReader::CandumpReader(const std::filesystem::path& file, Times times)
    : file_(file),
      opened_(std::make_unique<std::ifstream>(file, std::ios::binary)),
      stream_(*opened_),
      lines_(stream_),
      times_(times) {
  differences_ = times == Times::kDifferences;
  if (!stream_ || std::filesystem::is_directory(file)) throw InputError(file, 0, "no readable file", kLog);
}

CandumpReader::CandumpReader(std::istream& stream, const std::filesystem::path& name, Times times)
    : file_(name), stream_(stream), lines_(stream), times_(times) {
  differences_ = times == Times::kDifferences;
}

std::optional<LoggedFrame> CandumpReader::next() {
  while (lines_.next(text_)) {
    ++line_number_;
    LogLine line = parse_log_line(text_);
    if (stream_.eof() && !lines_.has_end() && line.kind != LineKind::kBlank) {
      end();
      if (!std::exchange(cut_off_, true))
        remark("the last line has no end, as after a crash; it is left out");
      return std::nullopt;
    }
    switch (line.kind) {
      case LineKind::kFrame:
        line.logged.time_us = time_of(line);
        return std::move(line.logged);
      case LineKind::kBlank:
        break;
      case LineKind::kDropped:
        remark(count_text(line.dropped, "frame") + " lost by candump");
        break;
      case LineKind::kScreen:
        throw InputError(file_, line_number_, "candump's format for the screen",
                         std::string(kLog) + ": record it with `candump -L` or `candump -l`");
      case LineKind::kMalformed:
        throw InputError(file_, line_number_, one_line(text_),
                         std::string(kLine) + (text_.find("##") != std::string::npos ? kFdSizes : ""));
    }
  }
  if (stream_.bad()) throw InputError(file_, line_number_, "a read error", "a readable file");
  end();
  return std::nullopt;
}

void CandumpReader::remark(int line, const std::string& text) {
  remarks_.push_back(file_.string() + ":" + std::to_string(line) + ": " + text);
}

// The remarks on the whole log, once.
void CandumpReader::end() {
  if (const std::uint64_t more = std::exchange(times_set_back_, 0); more > 1)
    remark("the clock was set back " + count_text(more, "time"));
  if (const std::uint64_t frames = std::exchange(disordered_, 0); frames > 0)
    remark(first_disorder_, count_text(frames, "frame") +
                                " out of order, this one first, by less than a second; they have the time of "
                                "the latest before them");
}

std::uint64_t CandumpReader::time_of(const LogLine& line) {
  const std::uint64_t time_us = line.logged.time_us;
  if (!std::exchange(begun_, true)) {
    relative_ = line.zero_padded && time_us == 0;
    if (relative_ && times_ == Times::kRecognised) {
      if (const int shown_in = line_of_differences(line.logged.interface)) {
        differences_ = true;
        remark(shown_in,
               "a time that is not after the previous one: the times are read as differences (candump -t d); "
               "--times absolute reads them as they are");
      }
    }
    last_interface_ = line.logged.interface;
    return last_us_ = time_us;
  }
  if (differences_) return last_us_ += time_us;
  if (time_us + offset_us_ < last_us_) return time_after_decrease(line);
  last_interface_ = line.logged.interface;
  return last_us_ = time_us + offset_us_;
}

std::uint64_t CandumpReader::time_after_decrease(const LogLine& line) {
  if (relative_ && times_ == Times::kRecognised) {
    throw InputError(file_, line_number_, "a time before the previous frame's",
                     "times since the first frame; --times delta reads those of `candump -t d`, and --times "
                     "absolute takes them as they are");
  }
  // Frames of two interfaces may be in disorder; more is a clock that was set back.
  const std::uint64_t back_us = last_us_ - line.logged.time_us - offset_us_;
  if (back_us > kMaxDisorder_us) {
    if (times_set_back_++ == 0)
      remark("the clock was set back by " + number_text(1e-6 * static_cast<double>(back_us)) + " s");
    offset_us_ += back_us;
  } else if (line.logged.interface == last_interface_) {
    if (disordered_++ == 0) first_disorder_ = line_number_;
  }
  return last_us_;
}

// Reads ahead. Times since the first frame neither decrease nor repeat, since a frame takes at least 47 us.
int CandumpReader::line_of_differences(const std::string& first_interface) {
  const std::istream::pos_type here = stream_.tellg();
  if (here == std::istream::pos_type(-1)) return 0;
  int found = 0;
  LineReader ahead(stream_);
  std::string text;
  LoggedFrame last{.frame = {}, .interface = first_interface};
  for (int number = line_number_ + 1; found == 0 && ahead.next(text); ++number) {
    const LogLine line = parse_log_line(text);
    if (line.kind != LineKind::kFrame) continue;
    const LoggedFrame& next = line.logged;
    if (next.time_us < last.time_us ||
        (next.time_us == last.time_us && next.time_us > 0 && next.interface == last.interface))
      found = number;
    last = next;
  }
  stream_.clear();
  stream_.seekg(here);
  return found;
}

}  // namespace koboshi::sim_board
