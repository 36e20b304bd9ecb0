#include "bus/can/scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "base/table/table.h"
#include "base/text/text.h"
#include "bus/can/describe.h"
#include "bus/can/sdo_transfer.h"
#include "bus/can/source.h"
#include "firmware/canopen/described_object.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/lss_slave.h"
#include "firmware/canopen/sdo/protocol.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::bus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr canopen::ObjectAddress kDeviceName{0x1008, 0};
constexpr std::uint16_t kIdentity = 0x1018;
constexpr auto kStopped = static_cast<std::uint8_t>(canopen::NmtState::kStopped);  // serves no SDO
constexpr int kFramesAtOnce = 1000;  // before the clock is read again

class Scanner {
 public:
  Scanner(sim_board::Transport& transport, const ScanOptions& options)
      : transport_(transport), options_(options) {}

  ScanResult run() {
    const Clock::time_point start = Clock::now();
    // A node may be booting, and the machine or the bus busy: what has not answered is asked twice, and again
    // while no node is found. The first channel of drives that are silent on the second is for those of other
    // makers.
    for (int round = 0; round < kScanRounds && (round < 2 || nodes_.empty()); ++round) {
      if (options_.first_node < options_.last_node) identify_unconfigured();
      request_all(options_.channel == SdoChannel::kSecond ||
                  (options_.channel == SdoChannel::kAutomatic && round % 2 == 0));
      listen(options_.listen_us, kMaxListening);
    }
    result_.duration_s = std::chrono::duration<double>(Clock::now() - start).count();
    for (auto& [node, found] : nodes_) {
      if (found.state != kStopped) read_objects(found);
      result_.nodes.push_back(found);
    }
    return result_;
  }

 private:
  using Microseconds = std::chrono::microseconds;

  void identify_unconfigured() {
    hal::CanFrame frame{.identifier = canopen::kLssRequestCobId, .size = 8};
    frame.data[0] = static_cast<std::uint8_t>(canopen::LssCommand::kIdentifyUnconfigured);
    send_surely(transport_, frame);
  }

  // Asks the nodes that have not answered, drives on their second or on their first channel.
  void request_all(bool drives_on_second) {
    for (std::uint8_t node = options_.first_node; node <= options_.last_node; ++node) {
      const bool second = drives_on_second && sim_board::has_pc_sdo(node);
      if (has_answered(node) || (options_.channel == SdoChannel::kSecond && !second)) continue;
      send_surely(transport_, device_type_request(node, second));
      listen(options_.request_period_us, 1);
    }
  }

  bool is_sought(std::uint8_t node) const {
    return options_.first_node <= node && node <= options_.last_node;
  }

  bool has_answered(std::uint8_t node) const {
    const auto found = nodes_.find(node);
    return found != nodes_.end() && found->second.answers_sdo;
  }

  // Each find prolongs the time, up to `most` times.
  void listen(std::uint64_t duration_us, unsigned most) {
    const Clock::time_point start = Clock::now();
    Clock::time_point end = start + Microseconds(duration_us);
    const Clock::time_point last = start + Microseconds(duration_us * most);
    for (;;) {
      const std::size_t before = finds_;
      for (int i = 0; i < kFramesAtOnce; ++i) {
        const auto frame = transport_.receive();
        if (!frame) break;
        take(*frame);
      }
      const Clock::time_point now = Clock::now();
      if (finds_ != before) end = std::min(last, now + Microseconds(duration_us));
      const auto left = std::chrono::duration_cast<Microseconds>(end - now).count();
      if (left <= 0) return;
      wait_for_frames(transport_, static_cast<std::uint64_t>(left));
    }
  }

  void take(const hal::CanFrame& frame) {
    ++result_.frames;
    result_.identifiers.insert(frame.identifier);
    if (frame.remote) return;
    if (frame.identifier == canopen::kLssResponseCobId)
      result_.unconfigured =
          result_.unconfigured ||
          (frame.size == 8 &&
           frame.data[0] == static_cast<std::uint8_t>(canopen::LssCommand::kIdentifiedUnconfigured));
    if (const int node = sim_board::node_of_pc_sdo_response(frame.identifier); node != 0)
      return take_answer(static_cast<std::uint8_t>(node), frame, true);
    const auto node = static_cast<std::uint8_t>(frame.identifier & canopen::kMaxNodeId);
    if (!is_sought(node)) return;
    const int base = frame.identifier & canopen::kFunctionCodeMask;
    if (base == canopen::kHeartbeatBase && frame.size == 1) {
      at(node).state = frame.data[0] & 0x7F;  // bit 7 is the toggle of node guarding
    } else if (base == canopen::kSdoResponseBase) {
      take_answer(node, frame, false);
    }
  }

  // An answer about the device type, which may be to another client's request.
  void take_answer(std::uint8_t node, const hal::CanFrame& frame, bool second) {
    const bool is_value =
        (frame.data[0] & canopen::sdo::kSpecifierMask) == canopen::sdo::kInitiateUploadResponse;
    if (frame.size != 8 || canopen::sdo::address_of(frame.data) != kDeviceType ||
        (!is_value && frame.data[0] != canopen::sdo::kAbort) || !is_sought(node))
      return;
    FoundNode& found = at(node);
    if (!std::exchange(found.answers_sdo, true)) ++finds_;
    if (is_value) found.device_type = canopen::sdo::data_of(frame.data);
    if (second) on_second_.insert(node);
  }

  FoundNode& at(std::uint8_t node) {
    const auto [place, is_new] = nodes_.try_emplace(node, FoundNode{.node = node});
    if (is_new) ++finds_;
    return place->second;
  }

  SdoTransfer channel_to(const FoundNode& found) {
    if (on_second_.contains(found.node)) return second_sdo(transport_, found.node);
    if (found.answers_sdo) return {transport_, found.node};
    return open_sdo(transport_, found.node,
                    sim_board::has_pc_sdo(found.node) ? options_.channel : SdoChannel::kFirst);
  }

  // A node need not have all parts of its identity, and no name. One that was just booting is asked again.
  void read_objects(FoundNode& found) {
    SdoTransfer sdo = channel_to(found);
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

  sim_board::Transport& transport_;
  ScanOptions options_;
  ScanResult result_;
  std::map<std::uint8_t, FoundNode> nodes_;
  std::set<std::uint8_t> on_second_;  // nodes that answer there
  std::size_t finds_ = 0;             // nodes, and answers of nodes
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

ScanResult scan_bus(sim_board::Transport& transport, const ScanOptions& options) {
  return Scanner(transport, options).run();
}

std::optional<FoundNode> find_node(sim_board::Transport& transport, std::uint8_t node_id,
                                   std::uint64_t timeout_us) {
  const ScanResult result = scan_bus(
      transport, {.listen_us = timeout_us / kScanRounds, .first_node = node_id, .last_node = node_id});
  return result.nodes.empty() ? std::nullopt : std::optional(result.nodes.front());
}

std::string sighting_text(const ScanResult& result) {
  constexpr std::size_t kShown = 8;
  if (result.frames == 0) return fmt::format("no frame passed within {:.1f} s", result.duration_s);
  std::string identifiers;
  std::size_t shown = 0;
  for (const std::uint16_t identifier : result.identifiers) {
    if (shown++ == kShown) break;
    identifiers += fmt::format("{}{:03X}", shown == 1 ? "" : ", ", identifier);
  }
  return fmt::format("{} passed within {:.1f} s, with the {} {}{}", count_text(result.frames, "frame"),
                     result.duration_s, result.identifiers.size() == 1 ? "identifier" : "identifiers",
                     identifiers,
                     shown > kShown ? fmt::format(" and {} others", result.identifiers.size() - kShown) : "");
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

}  // namespace koboshi::bus
