#include "bus/can/frame_text.h"

#include <fmt/core.h>

#include <charconv>
#include <optional>
#include <stdexcept>

namespace koboshi::bus {
namespace {

std::optional<std::uint64_t> number_of(std::string_view text, int base) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool read_data(std::string_view text, hal::CanFrame& frame) {
  if (text.size() % 2 != 0 || text.size() > 2 * frame.data.size()) return false;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto byte = number_of(text.substr(i, 2), 16);
    if (!byte) return false;
    frame.data[frame.size++] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

bool read_remote(std::string_view size, hal::CanFrame& frame) {
  frame.remote = true;
  if (size.empty()) return true;
  const auto number = number_of(size, 10);
  if (!number || *number > frame.data.size()) return false;
  frame.size = static_cast<std::uint8_t>(*number);
  return true;
}

}  // namespace

hal::CanFrame parse_frame(std::string_view text) {
  const std::size_t mark = text.find('#');
  if (mark != std::string_view::npos && mark <= 3) {
    const auto identifier = number_of(text.substr(0, mark), 16);
    const std::string_view rest = text.substr(mark + 1);
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(identifier.value_or(0))};
    const bool is_remote = !rest.empty() && (rest[0] == 'R' || rest[0] == 'r');
    if (identifier && *identifier <= 0x7FF &&
        (is_remote ? read_remote(rest.substr(1), frame) : read_data(rest, frame)))
      return frame;
  }
  throw std::invalid_argument(
      fmt::format("found the frame '{}', expected ID#DATA in hexadecimal, such as {}", text, kSampleFrame));
}

std::string frame_text(const hal::CanFrame& frame) {
  std::string text = fmt::format("{:03X}#", frame.identifier);
  if (frame.remote) return frame.size == 0 ? text + 'R' : fmt::format("{}R{}", text, frame.size);
  for (std::size_t i = 0; i < frame.size; ++i) text += fmt::format("{:02X}", frame.data[i]);
  return text;
}

std::uint64_t parse_number(std::string_view text, std::string_view what, std::uint64_t most) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const auto number = hexadecimal ? number_of(text.substr(2), 16) : number_of(text, 10);
  const bool octal = !hexadecimal && text.size() > 1 && text.starts_with('0');
  if (!number || *number > most || octal)
    throw std::invalid_argument(fmt::format("found {} '{}', expected a number up to {}", what, text, most));
  return *number;
}

std::uint64_t parse_hexadecimal(std::string_view text, std::string_view what, std::uint64_t most,
                                std::size_t digits) {
  const bool marked = text.starts_with("0x") || text.starts_with("0X");
  const auto number = number_of(marked ? text.substr(2) : text, 16);
  if (!number || *number > most)
    throw std::invalid_argument(
        fmt::format("found {} '{}', expected a hexadecimal number up to 0x{:X}", what, text, most));
  const auto decimal = number_of(text, 10);
  if (!marked && text.size() != digits && decimal && *decimal != *number)
    throw std::invalid_argument(
        fmt::format("found {} '{}', expected 0x{}, or 0x{:X} if it is decimal", what, text, text, *decimal));
  return *number;
}

}  // namespace koboshi::bus
