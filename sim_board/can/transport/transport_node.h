#pragma once

#include <cstdint>

#include "sim_board/can/bus.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// Everybody behind a transport, as one node of the simulated bus. It acknowledges what it hears, as their
// controllers would. As from any other node, the oldest process frame and the oldest service frame take part
// in the arbitration, however many wait behind them.
class TransportNode final : private BusNode {
 public:
  static constexpr std::size_t kTransmitFifo = 256;
  // Half a second of a full bus: several block transfers at once must not hold up the process data behind
  // them.
  static constexpr std::size_t kServiceFifo = 4096;  // SDO answers, and as much of what comes behind them

  struct Counters {
    std::uint64_t sent = 0;       // handed over to the transport
    std::uint64_t lost = 0;       // for which the transport had no room
    std::uint64_t received = 0;   // taken from it
    std::uint64_t refused = 0;    // for which this node's FIFO had no room
    std::uint64_t stalls = 0;     // polls that left frames outside: so many process data wait for the bus
    std::uint64_t dropped = 0;    // before they could be taken (Transport::dropped)
    std::uint64_t late_sent = 0;  // of those sent, while the simulation was behind the clock
    std::uint64_t late_received =
        0;  // of those received, while it was, or for which the bus was not free in time
  };

  // On the bus from now on. Both must outlive this node's last poll, and this the bus' last advance.
  TransportNode(Bus& bus, Transport& transport)
      : bus_(bus),
        transport_(transport),
        handle_(bus.attach(*this, AcceptanceFilter::all(), {kTransmitFifo, kServiceFifo, kServiceFifo})) {
    bus.bridge(handle_);
  }
  TransportNode(const TransportNode&) = delete;
  TransportNode& operator=(const TransportNode&) = delete;

  // Puts what has come in on the bus, as if it had been ready at this time. `behind`: the simulation is
  // behind the clock, and what is carried until the next call, either way, is late.
  void poll(std::uint64_t now_us, bool behind = false);
  Counters counters() const;

 private:
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;

  Bus& bus_;
  Transport& transport_;
  NodeHandle handle_;
  bool behind_ = false;
  Counters counters_;
};

}  // namespace koboshi::sim
