#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bus/can/sdo_transfer.h"
#include "firmware/canopen/frame.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::bus {

// Time and SDO channel of a scan.
struct ScanOptions {
  std::uint64_t listen_us = 1'000'000;      // after the last request and after each find
  std::uint64_t request_period_us = 2'000;  // a bus of 125 kbit/s carries request and answer in this time
  SdoChannel channel = SdoChannel::kAutomatic;
  std::uint8_t first_node = 1;  // others are neither asked nor reported
  std::uint8_t last_node = canopen::kMaxNodeId;
};

// A node of the bus. A value that it did not answer is missing.
struct FoundNode {
  std::uint8_t node = 0;
  std::optional<std::uint8_t> state{};  // of its last heartbeat; 0: boot-up
  bool answers_sdo = false;
  std::optional<std::uint32_t> device_type{};
  std::array<std::optional<std::uint32_t>, 4> identity{};  // vendor, product, revision, serial number (1018)
  std::string name{};                                      // 1008
};

struct ScanResult {
  std::vector<FoundNode> nodes{};         // ascending
  bool unconfigured = false;              // whether nodes without a node id answer LSS
  std::uint64_t frames = 0;               // that passed
  std::set<std::uint16_t> identifiers{};  // of them
  double duration_s = 0.0;                // of the search for nodes
};

inline constexpr int kScanRounds = 5;         // of requests, while no node is found; else two
inline constexpr unsigned kMaxListening = 5;  // times listen_us, while further nodes are found

// Finds the nodes of a bus: by their heartbeats, and by an SDO upload of object 1000 from each of the ids 1
// to 127, from drives on their second channel and then, if they do not answer, on the first. Reads the
// identity of those that answer.
ScanResult scan_bus(sim_board::Transport& transport, const ScanOptions& options);

// Returns the node that has this node id; nothing if no node with it answers by SDO or sends heartbeats
// within about this time. A node in NMT state stopped that sends no heartbeats is not found.
std::optional<FoundNode> find_node(sim_board::Transport& transport, std::uint8_t node_id,
                                   std::uint64_t timeout_us);

// A table with a line for each node.
std::string scan_table(const ScanResult& result);
// Describes what passed on a bus on which no node was found: "no frame passed within 5 s", "312 frames passed
// ...".
std::string sighting_text(const ScanResult& result);

}  // namespace koboshi::bus
