#include "tools/can/scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "firmware/canopen/described_object.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/lss_slave.h"
#include "firmware/canopen/sdo/protocol.h"
#include "tools/can/describe.h"
#include "tools/can/sdo_transfer.h"
#include "tools/can/source.h"
#include "tools/table/table.h"

namespace koboshi::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr canopen::ObjectAddress kDeviceType{0x1000, 0};
constexpr canopen::ObjectAddress kDeviceName{0x1008, 0};
constexpr std::uint16_t kIdentity = 0x1018;
constexpr auto kStopped = static_cast<std::uint8_t>(canopen::NmtState::kStopped);  // serves no SDO
// Between two requests: a bus of 125 kbit/s carries request and answer in 2 ms.
constexpr std::uint64_t kRequestPeriod_us = 2'000;

class Scanner {
 public:
  explicit Scanner(sim::Transport& transport) : transport_(transport) {}

  ScanResult run(std::uint64_t listen_us) {
    hal::CanFrame unconfigured{.identifier = canopen::kLssRequestCobId, .size = 8};
    unconfigured.data[0] = static_cast<std::uint8_t>(canopen::LssCommand::kIdentifyUnconfigured);
    send_surely(transport_, unconfigured);
    for (std::uint8_t node = 1; node <= canopen::kMaxNodeId; ++node) {
      send_surely(transport_,
                  {.identifier = static_cast<std::uint16_t>(canopen::kSdoRequestBase + node),
                   .size = 8,
                   .data = canopen::sdo::message(canopen::sdo::kInitiateUploadRequest, kDeviceType, 0)});
      listen(kRequestPeriod_us);
    }
    listen(listen_us);
    ScanResult result{.unconfigured = unconfigured_};
    for (auto& [node, found] : nodes_) {
      if (found.state != kStopped) read_objects(found);
      result.nodes.push_back(found);
    }
    return result;
  }

 private:
  void listen(std::uint64_t duration_us) {
    const Clock::time_point end = Clock::now() + std::chrono::microseconds(duration_us);
    for (;;) {
      while (const auto frame = transport_.receive()) take(*frame);
      const auto left = std::chrono::duration_cast<std::chrono::microseconds>(end - Clock::now()).count();
      if (left <= 0) return;
      wait_for_frames(transport_, static_cast<std::uint64_t>(left));
    }
  }

  void take(const hal::CanFrame& frame) {
    if (frame.remote) return;
    if (frame.identifier == canopen::kLssResponseCobId)
      unconfigured_ = unconfigured_ ||
                      (frame.size == 8 && frame.data[0] == static_cast<std::uint8_t>(
                                                               canopen::LssCommand::kIdentifiedUnconfigured));
    const auto node = static_cast<std::uint8_t>(frame.identifier & canopen::kMaxNodeId);
    if (node == 0) return;
    const int base = frame.identifier & canopen::kFunctionCodeMask;
    if (base == canopen::kHeartbeatBase && frame.size == 1) {
      at(node).state = frame.data[0] & 0x7F;  // bit 7 is the toggle of node guarding
    } else if (base == canopen::kSdoResponseBase && frame.size == 8 &&
               canopen::sdo::address_of(frame.data) == kDeviceType) {
      FoundNode& found = at(node);
      found.answers_sdo = true;
      if (frame.data[0] != canopen::sdo::kAbort) found.device_type = canopen::sdo::data_of(frame.data);
    }
  }

  FoundNode& at(std::uint8_t node) {
    FoundNode& found = nodes_[node];
    found.node = node;
    return found;
  }

  // A node need not have all parts of its identity, and no name. One that was just booting is asked again.
  void read_objects(FoundNode& found) {
    SdoTransfer sdo(transport_, found.node);
    const auto read = [&](canopen::ObjectAddress address) -> std::optional<std::vector<std::uint8_t>> {
      try {
        return sdo.read(address);
      } catch (const SdoAborted&) {
        return std::nullopt;
      }
    };
    const auto read_number = [&](canopen::ObjectAddress address) -> std::optional<std::uint32_t> {
      const auto data = read(address);
      if (!data || data->size() != 4) return std::nullopt;
      return canopen::load_u32(data->data());
    };
    try {
      if (!found.answers_sdo) found.device_type = read_number(kDeviceType);
      found.answers_sdo = true;
      for (std::size_t i = 0; i < found.identity.size(); ++i)
        found.identity[i] = read_number({kIdentity, static_cast<std::uint8_t>(i + 1)});
      if (const auto name = read(kDeviceName))
        found.name = {name->begin(), std::find(name->begin(), name->end(), 0)};
    } catch (const std::runtime_error&) {
      // It is silent, or has gone silent: what it answered counts.
    }
  }

  sim::Transport& transport_;
  std::map<std::uint8_t, FoundNode> nodes_;
  bool unconfigured_ = false;
};

std::string hex_text(std::optional<std::uint32_t> value) {
  return value ? fmt::format("{:08X}", *value) : std::string("-");
}

std::string state_text(const FoundNode& node) {
  if (!node.state) return "no heartbeat";
  const std::string_view name = canopen::name_of(canopen::kNmtStateNames, *node.state);
  return name.empty() ? fmt::format("unknown {:02X}", *node.state) : std::string(name);
}

}  // namespace

ScanResult scan_bus(sim::Transport& transport, std::uint64_t listen_us) {
  return Scanner(transport).run(listen_us);
}

std::string scan_table(const ScanResult& result) {
  std::vector<Row> rows;
  for (const FoundNode& node : result.nodes) {
    Row row{std::to_string(node.node), state_text(node), hex_text(node.device_type)};
    for (const auto& part : node.identity) row.push_back(hex_text(part));
    row.push_back(node.answers_sdo ? node.name : "no answer by SDO");
    rows.push_back(row);
  }
  return table_text({"node", "state", "type", "vendor", "product", "revision", "serial", "name"}, rows,
                    TableStyle::kTerminal);
}

}  // namespace koboshi::tools
