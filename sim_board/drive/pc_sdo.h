#pragma once

#include <array>
#include <cstdint>

namespace koboshi::sim_board {

// A drive's second SDO channel is there for the operator's PC: the first belongs to the controller. The node
// ids of two ranges have one. CiA 301 leaves 0x680 to 0x6DF free (table 40); the controller's joint target
// stream takes 0x680 to 0x68F, and each range its part of the rest, requests first.
struct PcSdoRange {
  std::uint8_t first_node;
  std::uint16_t request_base;  // to both the node id is added
  std::uint16_t response_base;
};
inline constexpr int kPcSdoNodes = 20;
inline constexpr std::array<PcSdoRange, 2> kPcSdoRanges{
    {{.first_node = 16, .request_base = 0x680, .response_base = 0x694},    // 16 to 35: 0x690 to 0x6B7
     {.first_node = 39, .request_base = 0x691, .response_base = 0x6A5}}};  // 39 to 58: 0x6B8 to 0x6DF
// For messages to users.
inline constexpr const char* kPcSdoNodesText = "16 to 35 or 39 to 58";

// Returns the range of a node's second channel; nullptr for a node without one.
constexpr const PcSdoRange* pc_sdo_range(int node_id) {
  for (const PcSdoRange& range : kPcSdoRanges) {
    if (node_id >= range.first_node && node_id < range.first_node + kPcSdoNodes) return &range;
  }
  return nullptr;
}
constexpr bool has_pc_sdo(int node_id) { return pc_sdo_range(node_id) != nullptr; }

// Return the identifiers of a node's second channel, which it must have.
constexpr std::uint16_t pc_sdo_request(int node_id) {
  return static_cast<std::uint16_t>(pc_sdo_range(node_id)->request_base + node_id);
}
constexpr std::uint16_t pc_sdo_response(int node_id) {
  return static_cast<std::uint16_t>(pc_sdo_range(node_id)->response_base + node_id);
}

// Return the node whose second channel has this identifier for requests or for responses; 0 if none has.
constexpr int node_of_pc_sdo_request(int identifier) {
  for (const PcSdoRange& range : kPcSdoRanges) {
    if (pc_sdo_range(identifier - range.request_base) == &range) return identifier - range.request_base;
  }
  return 0;
}
constexpr int node_of_pc_sdo_response(int identifier) {
  for (const PcSdoRange& range : kPcSdoRanges) {
    if (pc_sdo_range(identifier - range.response_base) == &range) return identifier - range.response_base;
  }
  return 0;
}

}  // namespace koboshi::sim_board
