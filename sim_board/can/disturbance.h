#pragma once

#include <cstdint>

#include "hal/port/can.h"
#include "sim_board/can/node.h"

namespace koboshi::sim_board {

// Effect of a disturbance on a transmission.
enum class WireEffect : std::uint8_t {
  kNone,
  kDestroyed,  // a bit error: all nodes see an error frame, and the sender retransmits
  // Only the sender detects an error, in the last bit of EOF. Its receivers have accepted the frame by then
  // (ISO 11898-1, "Frame validation") and answer its error flag with an overload flag; the sender
  // retransmits.
  kDoubled,
};

// Effect of a disturbance on a valid frame in one receiver's controller.
struct Reception {
  bool lost = false;           // acknowledged, then dropped
  std::uint64_t delay_us = 0;  // delay of the delivery after the frame's end
};

// Decides which transmissions fail.
class BusDisturbance {
 public:
  // Called once for each transmission, before it starts.
  virtual WireEffect on_transmission(const hal::CanFrame& frame, NodeHandle sender,
                                     std::uint64_t start_us) = 0;
  // Called at the end of a valid frame for each node that has been on the bus since its start, except its
  // senders, whether the node accepts the frame or not.
  virtual Reception on_reception(const hal::CanFrame& frame, NodeHandle receiver, std::uint64_t start_us) = 0;

 protected:
  ~BusDisturbance() = default;
};

}  // namespace koboshi::sim_board
