#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace koboshi::sim_board {

inline constexpr std::uint8_t kControllerNode = 1;
// The controller's telemetry also has the TPDO identifiers of this node (0x182, 0x282, 0x382), because those
// of its own are too few.
inline constexpr std::uint8_t kTelemetryNode = 2;
// Default node ids on a board whose sensors are nodes of the bus.
inline constexpr std::uint8_t kInertialNode = 36;
inline constexpr std::uint8_t kLeftAnkleNode = 37;
inline constexpr std::uint8_t kRightAnkleNode = 38;
inline constexpr std::array kAnkleNodes{kLeftAnkleNode, kRightAnkleNode};  // by hal::Side

// A CANopen node id that no drive may have, because its owner is on the same bus, or may be: whether sensors
// are nodes is chosen for each run.
struct ReservedNode {
  std::uint8_t node_id;
  std::string_view owner;
};

inline constexpr std::array kReservedNodes{
    ReservedNode{kControllerNode, "the controller"},
    ReservedNode{kTelemetryNode, "the controller's telemetry"},
    ReservedNode{kInertialNode, "the inertial sensor"},
    ReservedNode{kLeftAnkleNode, "the left ankle sensor"},
    ReservedNode{kRightAnkleNode, "the right ankle sensor"},
};

// Returns the owner of a reserved node id; empty for another one.
constexpr std::string_view owner_of_node(std::int64_t node_id) {
  const auto* const found = std::ranges::find(kReservedNodes, node_id, &ReservedNode::node_id);
  return found == kReservedNodes.end() ? std::string_view() : found->owner;
}

}  // namespace koboshi::sim_board
