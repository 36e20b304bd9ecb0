#include "bus/can/export.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <iterator>
#include <span>

#include "base/table/table.h"

namespace koboshi::bus {
namespace {

using Kind = sim_board::ForeignFrame::Kind;

constexpr std::uint64_t kMicrosecondsPerSecond = 1'000'000;

// A frame of either type, with what both formats need.
struct View {
  std::uint32_t identifier = 0;
  bool extended = false;
  bool remote = false;
  unsigned size = 0;
  std::span<const std::uint8_t> data{};  // none of a remote frame
};

template <typename Frame>
View view_of(const Frame& frame, bool extended) {
  const std::size_t size = frame.remote ? 0 : frame.size;
  return {frame.identifier, extended, frame.remote, frame.size, std::span(frame.data).first(size)};
}

View view_of(const TimedFrame& timed) {
  if (timed.standard() != nullptr) return view_of(*timed.standard(), false);
  const auto& foreign = std::get<sim_board::ForeignFrame>(timed.frame);
  return view_of(foreign, foreign.extended);
}

const sim_board::ForeignFrame* foreign_of(const TimedFrame& timed) {
  return std::get_if<sim_board::ForeignFrame>(&timed.frame);
}

std::string bytes_text(std::span<const std::uint8_t> data, const char* separator) {
  std::string text;
  for (const std::uint8_t byte : data) text += fmt::format("{}{:02X}", separator, byte);
  return text;
}

std::string time_text(std::uint64_t time_us, int width) {
  return fmt::format("{:{}}.{:06}", time_us / kMicrosecondsPerSecond, width,
                     time_us % kMicrosecondsPerSecond);
}

const char* format_name(const sim_board::ForeignFrame* foreign) {
  if (foreign == nullptr) return "standard";
  constexpr std::array kNames{"extended", "fd", "xl", "error"};
  return kNames[static_cast<std::size_t>(foreign->kind)];
}

// The data length code of CAN FD (ISO 11898-1, table 5).
unsigned dlc_of(unsigned size) {
  constexpr std::array<unsigned, 7> kSizes{12, 16, 20, 24, 32, 48, 64};  // of 9 to 15
  unsigned dlc = 9;
  if (size <= 8) return size;
  for (const unsigned one : kSizes) {
    if (size <= one) break;
    ++dlc;
  }
  return dlc;
}

std::string classic_asc(const View& frame, const char* direction) {
  const std::string identifier = fmt::format("{:X}{}", frame.identifier, frame.extended ? "x" : "");
  return fmt::format("{:<15} {:<4} {} {:X}{}", identifier, direction, frame.remote ? 'r' : 'd', frame.size,
                     bytes_text(frame.data, " "));
}

std::string fd_asc(const View& frame, std::uint8_t flags, int channel, const char* direction) {
  constexpr unsigned kFdFormat = 0x1000;
  const unsigned brs = flags & 1u;
  const unsigned esi = flags >> 1 & 1u;
  const std::string identifier = fmt::format("{:X}{}", frame.identifier, frame.extended ? "x" : "");
  return fmt::format(
      "CANFD {:3} {:<4} {:>11}                                  {} {} {:x} {:2}{} {:8} {:4} {:8X} 0 0 0 0 0",
      channel, direction, identifier, brs, esi, dlc_of(frame.size), frame.size, bytes_text(frame.data, " "),
      0, 0, kFdFormat | brs << 13 | esi << 14);
}

}  // namespace

std::string csv_head() {
  return csv_line(
      {"time_s", "interface", "direction", "identifier", "format", "remote", "size", "data", "description"});
}

std::string csv_row(const TimedFrame& timed, const std::string& description) {
  const View view = view_of(timed);
  const char* const direction = timed.direction == sim_board::Direction::kSent       ? "T"
                                : timed.direction == sim_board::Direction::kReceived ? "R"
                                                                                     : "";
  const std::string notation = sim_board::frame_notation(timed.frame);
  return csv_line({time_text(timed.time_us, 0), timed.interface, direction,
                   notation.substr(0, notation.find('#')), format_name(foreign_of(timed)),
                   view.remote ? "1" : "0", std::to_string(view.size), bytes_text(view.data, ""),
                   description});
}

std::string AscWriter::head() { return "base hex  timestamps absolute\nno internal events logged\n"; }

std::string AscWriter::line(const TimedFrame& timed) {
  const sim_board::ForeignFrame* const foreign = foreign_of(timed);
  if (foreign != nullptr && foreign->kind == Kind::kXl) return {};
  const int channel = channel_of(timed.interface);
  const char* const direction = timed.direction == sim_board::Direction::kSent ? "Tx" : "Rx";
  const View view = view_of(timed);
  const std::string time = time_text(timed.time_us, 4);
  if (foreign != nullptr && foreign->kind == Kind::kFd)
    return fmt::format("{} {}\n", time, fd_asc(view, foreign->flags, channel, direction));
  const bool error = foreign != nullptr && foreign->kind == Kind::kError;
  return fmt::format("{} {:<2} {}\n", time, channel, error ? "ErrorFrame" : classic_asc(view, direction));
}

// asc2log names the channels can0, can1, ... So canN has channel N + 1, and others the next free one.
int AscWriter::channel_of(const std::string& interface) {
  const auto known = channels_.find(interface);
  if (known != channels_.end()) return known->second;
  int channel = 0;
  const std::size_t digits = interface.find_last_not_of("0123456789") + 1;
  const auto [end, error] =
      std::from_chars(interface.data() + digits, interface.data() + interface.size(), channel);
  channel = error == std::errc() ? channel + 1 : 1;
  while (!taken_.insert(channel).second) ++channel;
  channels_[interface] = channel;
  return channel;
}

}  // namespace koboshi::bus
