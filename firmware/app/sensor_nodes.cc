#include "firmware/app/sensor_nodes.h"

namespace koboshi::app {

void SensorNodes::note_boot_up(const hal::CanFrame& frame) {
  const auto heartbeat = canopen::decode_heartbeat(frame);
  if (!heartbeat || heartbeat->state != canopen::NmtState::kInitialising) return;
  for (std::size_t i = 0; i < node_ids_.size(); ++i) {
    const std::uint32_t bit = std::uint32_t{1} << i;
    // A boot-up message before the reset is not the one to wait for.
    if (node_ids_[i] == heartbeat->node_id && (to_reset_ & bit) == 0) to_start_ |= bit;
  }
}

// Sends a command to the nodes for which it is due, as far as the sink has room; the others wait for the next
// call.
void SensorNodes::send(canopen::NmtCommand command, std::uint32_t& due) {
  for (std::size_t i = 0; i < node_ids_.size(); ++i) {
    const std::uint32_t bit = std::uint32_t{1} << i;
    if ((due & bit) == 0) continue;
    if (!sink_.send(canopen::encode(canopen::NmtMessage{.command = command, .node_id = node_ids_[i]})))
      return;
    due &= ~bit;
  }
}

}  // namespace koboshi::app
