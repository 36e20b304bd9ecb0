#pragma once

#include <cstdint>

#include "hal/port/can.h"

namespace koboshi::sim_board {

// Identifies a node on its bus.
enum class NodeHandle : std::uint16_t {};

// A node on the bus. It receives each frame at the microsecond at which the frame's last bit has passed.
class BusNode {
 public:
  virtual void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) = 0;

 protected:
  ~BusNode() = default;
};

}  // namespace koboshi::sim_board
