#include <fmt/core.h>

#include <optional>

#include "bus/can/describe.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/lss_slave.h"

namespace koboshi::bus {
namespace {

using canopen::LssCommand;
using LssData = std::array<std::uint8_t, 8>;

constexpr const char* kIdentityNames[] = {"vendor id", "product code", "revision number", "serial number"};
constexpr const char* kIdentifyNames[] = {"vendor id",
                                          "product code",
                                          "lowest revision number",
                                          "highest revision number",
                                          "lowest serial number",
                                          "highest serial number"};
constexpr std::uint8_t kAnySlave = 0x80;  // BitCheck of fastscan

// Returns how far a command is behind the first one of a series, if it belongs to it.
std::optional<std::size_t> place_in_series(std::uint8_t command, LssCommand first, std::size_t count) {
  const int place = command - static_cast<int>(first);
  if (place < 0 || static_cast<std::size_t>(place) >= count) return std::nullopt;
  return static_cast<std::size_t>(place);
}

std::string numbered(const char* name, const LssData& data) {
  return fmt::format("{} {:08X}", name, canopen::load_u32(&data[1]));
}

std::string node_id_text(std::uint8_t node_id) {
  return node_id == canopen::kUnconfiguredNodeId ? "no node id" : fmt::format("node id {}", node_id);
}

std::string fastscan_text(const LssData& data) {
  if (data[5] == kAnySlave) return "fastscan, any slave without a node id";
  if (data[6] >= std::size(kIdentityNames) || data[5] > 31) return "fastscan with invalid parameters";
  return fmt::format("fastscan, {} from bit {} on", numbered(kIdentityNames[data[6]], data), data[5]);
}

std::string lss_request_text(const LssData& data) {
  if (const auto part = place_in_series(data[0], LssCommand::kSwitchVendor, std::size(kIdentityNames)))
    return "select " + numbered(kIdentityNames[*part], data);
  if (const auto part = place_in_series(data[0], LssCommand::kIdentifyVendor, std::size(kIdentifyNames)))
    return "identify " + numbered(kIdentifyNames[*part], data);
  if (const auto part = place_in_series(data[0], LssCommand::kInquireVendor, std::size(kIdentityNames)))
    return fmt::format("inquire {}", kIdentityNames[*part]);
  switch (static_cast<LssCommand>(data[0])) {
    case LssCommand::kSwitchGlobal:
      return data[1] > 1 ? fmt::format("all slaves to unknown mode {}", data[1])
                         : fmt::format("all slaves to {}", data[1] == 1 ? "configuration" : "waiting");
    case LssCommand::kConfigureNodeId:
      return "configure " + node_id_text(data[1]);
    case LssCommand::kConfigureBitTiming:
      return fmt::format("configure bit timing {} of table {}", data[2], data[1]);
    case LssCommand::kActivateBitTiming:
      return fmt::format("activate bit timing after {} ms", canopen::load_u16(&data[1]));
    case LssCommand::kStore:
      return "store";
    case LssCommand::kIdentifyUnconfigured:
      return "identify slaves without a node id";
    case LssCommand::kFastscan:
      return fastscan_text(data);
    case LssCommand::kInquireNodeId:
      return "inquire node id";
    default:
      return fmt::format("unknown command {:02X}", data[0]);
  }
}

std::string result_text(const char* what, const LssData& data) {
  return data[1] == 0 ? fmt::format("{} done", what)
                      : fmt::format("{} refused, error {}, {}", what, data[1], data[2]);
}

std::string lss_response_text(const LssData& data) {
  if (const auto part = place_in_series(data[0], LssCommand::kInquireVendor, std::size(kIdentityNames)))
    return numbered(kIdentityNames[*part], data);
  switch (static_cast<LssCommand>(data[0])) {
    case LssCommand::kConfigureNodeId:
      return result_text("configure node id", data);
    case LssCommand::kConfigureBitTiming:
      return result_text("configure bit timing", data);
    case LssCommand::kStore:
      return result_text("store", data);
    case LssCommand::kSwitched:
      return "selected, in configuration";
    case LssCommand::kIdentified:
      return "identified";
    case LssCommand::kIdentifiedUnconfigured:
      return "identified, no node id";
    case LssCommand::kInquireNodeId:
      return node_id_text(data[1]);
    default:
      return fmt::format("unknown command {:02X}", data[0]);
  }
}

}  // namespace

std::string describe_lss(const hal::CanFrame& frame) {
  if (frame.size != 8) return "LSS of wrong length";
  return frame.identifier == canopen::kLssRequestCobId ? "LSS master: " + lss_request_text(frame.data)
                                                       : "LSS slave: " + lss_response_text(frame.data);
}

}  // namespace koboshi::bus
