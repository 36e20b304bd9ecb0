#pragma once

#include <cstdint>

namespace koboshi::sim_board {

// A drive's second SDO channel is there for the operator's PC: the first belongs to the controller. Bases to
// which the node id is added; for the ids 16 to 35 they fall into 0x690 to 0x6B7, which CiA 301 leaves free.
inline constexpr std::uint16_t kPcSdoRequestBase = 0x680;
inline constexpr std::uint16_t kPcSdoResponseBase = 0x694;
inline constexpr std::uint8_t kFirstPcSdoNode = 16;
inline constexpr std::uint8_t kLastPcSdoNode = 35;
constexpr bool has_pc_sdo(std::uint8_t node_id) {
  return node_id >= kFirstPcSdoNode && node_id <= kLastPcSdoNode;
}

}  // namespace koboshi::sim_board
