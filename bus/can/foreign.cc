// Foreign frames in words.

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <span>

#include "bus/can/describe.h"

namespace koboshi::bus {
namespace {

using Kind = sim_board::ForeignFrame::Kind;

// A bit of a number and its meaning.
struct Flag {
  std::uint32_t bit;
  const char* name;
};

// linux/can/error.h
constexpr Flag kErrorClasses[] = {
    {0x001, "transmission timed out"},
    {0x002, "arbitration lost"},
    {0x004, "controller"},
    {0x008, "protocol violation"},
    {0x010, "transceiver"},
    {0x020, "no acknowledgement"},
    {0x040, "bus-off"},
    {0x080, "bus error"},
    {0x100, "restarted after bus-off"},
};
constexpr Flag kControllerErrors[] = {
    {0x01, "receive overflow"},   {0x02, "transmit overflow"},     {0x04, "receive warning"},
    {0x08, "transmit warning"},   {0x10, "receive error passive"}, {0x20, "transmit error passive"},
    {0x40, "error active again"},
};
constexpr Flag kProtocolErrors[] = {
    {0x01, "single bit"},          {0x02, "frame format"},       {0x04, "bit stuffing"},
    {0x08, "bit stuck recessive"}, {0x10, "bit stuck dominant"}, {0x20, "overload"},
    {0x40, "error active again"},  {0x80, "while transmitting"},
};

std::string names_of(std::span<const Flag> flags, std::uint32_t value) {
  std::string names;
  for (const Flag& flag : flags) {
    if ((value & flag.bit) != 0) names += (names.empty() ? "" : ", ") + std::string(flag.name);
  }
  return names;
}

std::string details(std::span<const Flag> flags, std::uint8_t value) {
  const std::string names = names_of(flags, value);
  return names.empty() ? "" : " (" + names + ")";
}

std::string error_text(const sim_board::ForeignFrame& frame) {
  std::string text;
  for (const Flag& one : kErrorClasses) {
    if ((frame.identifier & one.bit) == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(one.name);
    if (one.bit == 0x004) text += details(kControllerErrors, frame.data[1]);
    if (one.bit == 0x008) text += details(kProtocolErrors, frame.data[2]);
  }
  if (text.empty()) text = "unspecified";
  if (frame.data[6] != 0 || frame.data[7] != 0)
    text += fmt::format(", {} transmit and {} receive errors", frame.data[6], frame.data[7]);
  return "error frame: " + text;
}

std::string fd_text(const sim_board::ForeignFrame& frame) {
  std::string text = frame.extended ? "CAN FD, 29-bit identifier" : "CAN FD";
  if ((frame.flags & 1) != 0) text += ", bit rate switch";
  if ((frame.flags & 2) != 0) text += ", sender error passive";
  return text;
}

// In the order of ForeignCount's counts.
struct Names {
  const char* one;
  const char* several;
};
constexpr Names kNames[] = {{"with a 29-bit identifier", "with 29-bit identifiers"},
                            {"in the format of CAN FD", "in the format of CAN FD"},
                            {"in the format of CAN XL", "in the format of CAN XL"},
                            {"error frame", "error frames"},
                            {"remote frame", "remote frames"}};
constexpr std::size_t kRemote = 4;

}  // namespace

std::string describe(const sim_board::ForeignFrame& frame) {
  switch (frame.kind) {
    case Kind::kExtended:
      return frame.remote ? "29-bit identifier, remote request" : "29-bit identifier";
    case Kind::kFd:
      return fd_text(frame);
    case Kind::kXl:
      return "CAN XL";
    case Kind::kError:
      return error_text(frame);
  }
  return {};
}

void ForeignCount::add(const sim_board::BusFrame& frame) {
  if (const auto* foreign = std::get_if<sim_board::ForeignFrame>(&frame)) {
    ++counts_[static_cast<std::size_t>(foreign->kind)];
  } else if (std::get<hal::CanFrame>(frame).remote) {
    ++counts_[kRemote];
  }
}

bool ForeignCount::empty() const {
  return std::ranges::all_of(counts_, [](std::uint64_t count) { return count == 0; });
}

std::string ForeignCount::text() const {
  std::string text;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts_[i],
                        counts_[i] == 1 ? kNames[i].one : kNames[i].several);
  }
  return text;
}

}  // namespace koboshi::bus
