#include "sim_board/can/transport/slcan.h"

#include <fcntl.h>
#include <pty.h>
#include <termios.h>

#include <array>
#include <charconv>

namespace koboshi::sim_board {
namespace {

using hal::checked;

constexpr std::string_view kDone = "\r";
constexpr std::string_view kRefused = "\a";
constexpr std::string_view kDigits = "0123456789ABCDEF";
constexpr std::uint64_t kStampPeriod_ms = 60'000;

// Returns nothing unless the whole text is one number.
std::optional<unsigned> hex(std::string_view text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void append_hex(std::string& text, unsigned value, int digits) {
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) text += kDigits[(value >> shift) & 0xF];
}

// Parses tiiildd.. and riiil.
std::optional<hal::CanFrame> frame_of(std::string_view command) {
  if (command.size() < 5) return std::nullopt;
  const auto identifier = hex(command.substr(1, 3));
  const auto size = hex(command.substr(4, 1));
  if (!identifier || *identifier > 0x7FF || !size || *size > 8) return std::nullopt;
  hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(*identifier),
                      .size = static_cast<std::uint8_t>(*size),
                      .remote = command[0] == 'r'};
  const std::string_view data = command.substr(5);
  if (data.size() != (frame.remote ? 0u : 2u * *size)) return std::nullopt;
  for (std::size_t i = 0; i < data.size() / 2; ++i) {
    const auto byte = hex(data.substr(2 * i, 2));
    if (!byte) return std::nullopt;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return frame;
}

}  // namespace

std::string SlcanProtocol::take(std::string_view text) {
  std::string answers;
  for (const char letter : text) {
    if (letter == '\n') continue;
    if (letter != '\r') {
      if (command_.size() <= kMaxCommandLength) command_ += letter;
      continue;
    }
    if (!command_.empty()) answers += obey(command_);
    command_.clear();
  }
  return answers;
}

std::string SlcanProtocol::obey(std::string_view command) {
  switch (command[0]) {
    case 'O':
    case 'L':
      if (open_) return std::string(kRefused);
      open_ = true;
      listens_only_ = command[0] == 'L';
      return std::string(kDone);
    case 'C':
      open_ = false;
      return std::string(kDone);
    case 't':
    case 'r':
      return transmit(command);
    case 'F':
      return "F00\r";
    case 'V':
      return "V1013\r";
    case 'N':
      return "NKBSH\r";
    case 'Z':
      stamps_ = command == "Z1";
      return std::string(kDone);
    case 'S':  // bit rate, filters and modes of the adapter: accepted without effect
    case 's':
    case 'M':
    case 'm':
    case 'W':
    case 'X':
    case 'Q':
    case 'U':
      return std::string(kDone);
    default:  // includes T and R: 29-bit identifiers are not supported
      return std::string(kRefused);
  }
}

std::string SlcanProtocol::transmit(std::string_view command) {
  const auto frame = frame_of(command);
  if (!frame || !open_ || listens_only_) return std::string(kRefused);
  frames_.push_back(*frame);
  return "z\r";
}

std::string SlcanProtocol::line_of(const hal::CanFrame& frame, std::uint64_t time_us) const {
  if (!open_) return {};
  std::string line(1, frame.remote ? 'r' : 't');
  append_hex(line, frame.identifier, 3);
  append_hex(line, frame.size, 1);
  for (std::size_t i = 0; !frame.remote && i < frame.size; ++i) append_hex(line, frame.data[i], 2);
  if (stamps_) append_hex(line, static_cast<unsigned>(time_us / 1000 % kStampPeriod_ms), 4);
  return line += '\r';
}

Slcan::Slcan() {
  int adapter = -1;
  int terminal = -1;
  std::array<char, 256> name{};
  termios raw{};
  cfmakeraw(&raw);
  checked(openpty(&adapter, &terminal, name.data(), &raw, nullptr), "a pseudo-terminal");
  adapter_ = hal::FileDescriptor(adapter);
  terminal_ = hal::FileDescriptor(terminal);
  place_ = name.data();
  checked(fcntl(adapter, F_SETFL, O_NONBLOCK), "a pseudo-terminal");
}

bool Slcan::send(const hal::CanFrame& frame, std::uint64_t time_us) {
  const std::string line = protocol_.line_of(frame, time_us);
  return !line.empty() && write_out(line);
}

std::optional<hal::CanFrame> Slcan::receive() {
  if (protocol_.frames().empty()) listen();
  if (protocol_.frames().empty()) return std::nullopt;
  const hal::CanFrame frame = protocol_.frames().front();
  protocol_.frames().pop_front();
  return frame;
}

void Slcan::listen() {
  std::array<char, 4096> text{};
  const ssize_t got = ::read(adapter_.number(), text.data(), text.size());
  if (got > 0) write_out(protocol_.take({text.data(), static_cast<std::size_t>(got)}));
}

// Writes each line completely or not at all; the rest of a partly written line comes first.
bool Slcan::write_out(std::string_view text) {
  if (text.empty()) return true;
  if (!unsent_.empty()) {
    const ssize_t wrote = ::write(adapter_.number(), unsent_.data(), unsent_.size());
    if (wrote > 0) unsent_.erase(0, static_cast<std::size_t>(wrote));
    if (!unsent_.empty()) return false;
  }
  const ssize_t wrote = ::write(adapter_.number(), text.data(), text.size());
  if (wrote <= 0) return false;
  unsent_ = text.substr(static_cast<std::size_t>(wrote));
  return true;
}

}  // namespace koboshi::sim_board
