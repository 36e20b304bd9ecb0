#include "cli/can/frame_description.h"

#include <fmt/core.h>

#include "bus/can/describe.h"

namespace koboshi::cli {
namespace {

// Decodes a PDO: its name, then each value with its unit or its name.
std::string values_text(const bus::Network& network, const hal::CanFrame& frame) {
  const bus::Message* message = network.find(frame.identifier);
  if (message == nullptr) return {};
  std::string text = message->name + ":";
  for (const bus::Reading& reading : bus::decode(network, frame)) {
    text += fmt::format(" {}=", reading.signal->name);
    text += reading.name.empty() ? fmt::format("{:.6g}", reading.value) : fmt::format("'{}'", reading.name);
    if (reading.name.empty() && !reading.signal->unit.empty()) text += " " + reading.signal->unit;
  }
  return text;
}

}  // namespace

std::string frame_description(const sim_board::BusFrame& frame, const bus::Network& network,
                              bool is_segment) {
  if (const auto* foreign = std::get_if<sim_board::ForeignFrame>(&frame)) return bus::describe(*foreign);
  const auto& standard = std::get<hal::CanFrame>(frame);
  const std::string text = bus::describe(standard, {}, is_segment);
  return text.empty() ? values_text(network, standard) : text;
}

bool FollowedBlocks::follow(const bus::TimedFrame& timed) {
  const hal::CanFrame* frame = timed.standard();
  return frame != nullptr && interfaces_[timed.interface].follow(*frame);
}

}  // namespace koboshi::cli
