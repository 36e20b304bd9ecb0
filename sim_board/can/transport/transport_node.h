#pragma once

#include <cstdint>

#include "sim_board/can/bus.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {

// Represents all nodes behind a transport as one node of the simulated bus. It acknowledges frames, as their
// controllers would. As with any other node, only the oldest process frame and the oldest service frame take
// part in the arbitration.
class TransportNode final : private BusNode {
 public:
  static constexpr std::size_t kTransmitFifo = 256;
  // Half a second of a full bus: several simultaneous block transfers must not delay the process data behind
  // them.
  static constexpr std::size_t kServiceFifo = 4096;  // for SDO answers and frames behind them

  struct Counters {
    std::uint64_t sent = 0;       // passed to the transport
    std::uint64_t lost = 0;       // refused by the transport for lack of room
    std::uint64_t received = 0;   // taken from the transport
    std::uint64_t refused = 0;    // no room in this node's FIFO
    std::uint64_t stalls = 0;     // polls that left frames in the transport because the process FIFO was full
    std::uint64_t dropped = 0;    // lost before reception (Transport::dropped)
    std::uint64_t late_sent = 0;  // sent frames while the simulation lagged behind real time
    std::uint64_t late_received =
        0;  // received frames while it lagged, or for which the bus was not free in time
  };

  // Attaches itself to the bus. Bus and transport must outlive this node's last poll, and this node the bus'
  // last advance.
  TransportNode(Bus& bus, Transport& transport)
      : bus_(bus),
        transport_(transport),
        handle_(bus.attach(*this, AcceptanceFilter::all(), {kTransmitFifo, kServiceFifo, kServiceFifo})) {
    bus.bridge(handle_);
  }
  TransportNode(const TransportNode&) = delete;
  TransportNode& operator=(const TransportNode&) = delete;

  // Queues the received frames, ready at `now_us`. `behind`: the simulation lags behind real time, so all
  // frames in either direction until the next call count as late.
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

}  // namespace koboshi::sim_board
