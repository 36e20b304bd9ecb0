#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/can/transport/transport.h"

namespace koboshi::tools {

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
  std::vector<FoundNode> nodes{};  // ascending
  bool unconfigured = false;       // whether nodes without a node id answer LSS
};

// Finds the nodes of a bus: by their heartbeats, and by an SDO upload of object 1000 from each of the ids 1
// to 127. Reads the identity of those that answer. Listens for `listen_us` after the last request.
ScanResult scan_bus(sim::Transport& transport, std::uint64_t listen_us);

// A table with a line for each node.
std::string scan_table(const ScanResult& result);

}  // namespace koboshi::tools
