#pragma once

#include <cstdint>

#include "sim_board/can/bus.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// Everybody behind a transport, as one node of the simulated bus. It acknowledges what it hears, as their
// controllers would.
class TransportNode final : private BusNode {
 public:
  static constexpr std::size_t kTransmitFifo = 256;

  struct Counters {
    std::uint64_t sent = 0;      // handed over to the transport
    std::uint64_t lost = 0;      // for which the transport had no room
    std::uint64_t received = 0;  // taken from it
    std::uint64_t refused = 0;   // for which this node's FIFO had no room
  };

  // On the bus from now on. Both must outlive this node's last poll, and this the bus' last advance.
  TransportNode(Bus& bus, Transport& transport)
      : bus_(bus),
        transport_(transport),
        handle_(bus.attach(*this, AcceptanceFilter::all(), kTransmitFifo)) {}
  TransportNode(const TransportNode&) = delete;
  TransportNode& operator=(const TransportNode&) = delete;

  // Puts what has come in on the bus, as if it had been ready at this time.
  void poll(std::uint64_t now_us);
  const Counters& counters() const { return counters_; }

 private:
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;

  Bus& bus_;
  Transport& transport_;
  NodeHandle handle_;
  Counters counters_;
};

}  // namespace koboshi::sim
