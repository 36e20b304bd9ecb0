#include "firmware/canopen/frame.h"

#include <algorithm>

namespace koboshi::canopen {
namespace {

std::uint16_t with_node(std::uint16_t base, std::uint8_t node_id) {
  return static_cast<std::uint16_t>(base + node_id);
}

// The node id of an identifier above `base`; 0 when the identifier belongs to another service.
std::uint8_t node_of(const hal::CanFrame& frame, std::uint16_t base) {
  if (frame.identifier <= base || frame.identifier > base + kMaxNodeId) return 0;
  return static_cast<std::uint8_t>(frame.identifier - base);
}

bool is_command(std::uint8_t value) {
  switch (static_cast<NmtCommand>(value)) {
    case NmtCommand::kStart:
    case NmtCommand::kStop:
    case NmtCommand::kEnterPreOperational:
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      return true;
  }
  return false;
}

bool is_state(std::uint8_t value) {
  switch (static_cast<NmtState>(value)) {
    case NmtState::kInitialising:
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational:
      return true;
  }
  return false;
}

}  // namespace

hal::CanFrame encode(const NmtMessage& message) {
  hal::CanFrame frame{.identifier = kNmtCobId, .size = 2};
  frame.data[0] = static_cast<std::uint8_t>(message.command);
  frame.data[1] = message.node_id;
  return frame;
}

hal::CanFrame encode(const Emergency& emergency) {
  hal::CanFrame frame{.identifier = with_node(kEmergencyBase, emergency.node_id), .size = 8};
  store_u16(frame.data.data(), emergency.code);
  frame.data[2] = emergency.error_register;
  std::copy(emergency.manufacturer.begin(), emergency.manufacturer.end(), frame.data.begin() + 3);
  return frame;
}

hal::CanFrame encode(const Heartbeat& heartbeat) {
  hal::CanFrame frame{.identifier = with_node(kHeartbeatBase, heartbeat.node_id), .size = 1};
  frame.data[0] = static_cast<std::uint8_t>(heartbeat.state);
  return frame;
}

std::optional<NmtMessage> decode_nmt(const hal::CanFrame& frame) {
  if (frame.remote || frame.identifier != kNmtCobId || frame.size != 2) return std::nullopt;
  if (!is_command(frame.data[0]) || frame.data[1] > kMaxNodeId) return std::nullopt;
  return NmtMessage{static_cast<NmtCommand>(frame.data[0]), frame.data[1]};
}

std::optional<Emergency> decode_emergency(const hal::CanFrame& frame) {
  const std::uint8_t node_id = node_of(frame, kEmergencyBase);
  if (frame.remote || node_id == 0 || frame.size != 8) return std::nullopt;
  Emergency emergency{
      .node_id = node_id, .code = load_u16(frame.data.data()), .error_register = frame.data[2]};
  std::copy(frame.data.begin() + 3, frame.data.end(), emergency.manufacturer.begin());
  return emergency;
}

std::optional<Heartbeat> decode_heartbeat(const hal::CanFrame& frame) {
  const std::uint8_t node_id = node_of(frame, kHeartbeatBase);
  if (frame.remote || node_id == 0 || frame.size != 1) return std::nullopt;
  const std::uint8_t state = frame.data[0] & 0x7F;  // bit 7 is the toggle bit of node guarding
  if (!is_state(state)) return std::nullopt;
  return Heartbeat{node_id, static_cast<NmtState>(state)};
}

}  // namespace koboshi::canopen
