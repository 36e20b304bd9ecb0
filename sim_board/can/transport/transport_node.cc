#include "sim_board/can/transport/transport_node.h"

namespace koboshi::sim {

void TransportNode::poll(std::uint64_t now_us) {
  // No more than fits: what floods in from outside waits there, or is lost there.
  while (bus_.transmit_space(handle_) > 0) {
    const auto frame = transport_.receive();
    if (!frame) return;
    ++counters_.received;
    if (!bus_.queue(handle_, *frame, now_us)) ++counters_.refused;
  }
}

void TransportNode::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  ++(transport_.send(frame, time_us) ? counters_.sent : counters_.lost);
}

}  // namespace koboshi::sim
