#pragma once

#include <cstdint>

#include "hal/port/can.h"

namespace koboshi::sim_board {

// Receives every valid frame on the bus, in the order of their ends and before any node. It is not a node: it
// neither acknowledges nor sends.
class BusObserver {
 public:
  // The frame occupied the wire from `start_us` (SOF) to `end_us` (after the last bit of EOF).
  virtual void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) = 0;

 protected:
  ~BusObserver() = default;
};

}  // namespace koboshi::sim_board
