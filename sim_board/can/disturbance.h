#pragma once

#include <cstdint>

#include "hal/port/can.h"
#include "sim_board/can/node.h"

namespace koboshi::sim {

// What a disturbance makes of a transmission on the wire.
enum class WireEffect : std::uint8_t {
  kNone,
  kDestroyed,  // a bit error: all nodes see an error frame, and the frame is sent again
  // The sender alone sees an error, in the last bit of EOF. Its receivers have taken the frame by then (ISO
  // 11898-1, "Frame validation") and answer its error flag with an overload flag; it is sent again.
  kDoubled,
};

// What a disturbance makes of a sound frame in the controller of one of its receivers.
struct Reception {
  bool lost = false;           // acknowledged, then dropped
  std::uint64_t delay_us = 0;  // how long after its end the node is told of it
};

// Decides what goes wrong on a bus.
class BusDisturbance {
 public:
  // Asked once for each transmission, before it starts.
  virtual WireEffect on_transmission(const hal::CanFrame& frame, NodeHandle sender,
                                     std::uint64_t start_us) = 0;
  // Asked for each receiver of a sound frame, at its end.
  virtual Reception on_reception(const hal::CanFrame& frame, NodeHandle receiver, std::uint64_t start_us) = 0;

 protected:
  ~BusDisturbance() = default;
};

}  // namespace koboshi::sim
