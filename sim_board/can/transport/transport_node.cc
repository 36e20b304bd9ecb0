#include "sim_board/can/transport/transport_node.h"

#include <algorithm>

namespace koboshi::sim_board {

void TransportNode::poll(std::uint64_t now_us, bool behind) {
  behind_ = behind;
  // Takes only as many process data frames as fit: the rest waits in the transport or is lost there.
  while (bus_.transmit_space(handle_, hal::kProcessFifo) > 0) {
    const auto frame = transport_.receive();
    if (!frame) return;
    ++counters_.received;
    if (behind) ++counters_.late_received;
    if (!bus_.queue(handle_, *frame, now_us)) ++counters_.refused;
  }
  ++counters_.stalls;
}

TransportNode::Counters TransportNode::counters() const {
  Counters counters = counters_;
  counters.dropped = transport_.dropped();
  // A frame can be late for both reasons.
  counters.late_received = std::min(counters.received, counters.late_received + bus_.counters(handle_).late);
  return counters;
}

void TransportNode::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  const bool sent = transport_.send(frame, time_us);
  ++(sent ? counters_.sent : counters_.lost);
  if (sent && behind_) ++counters_.late_sent;
}

}  // namespace koboshi::sim_board
