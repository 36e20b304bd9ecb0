#pragma once

#include <cstdint>

#include "hal/port/can.h"

namespace koboshi::sim {

// A node's place on its bus.
enum class NodeHandle : std::uint16_t {};

// What stands on the bus: is told of every frame that reaches it, at the microsecond at which its last bit
// has passed.
class BusNode {
 public:
  virtual void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) = 0;

 protected:
  ~BusNode() = default;
};

}  // namespace koboshi::sim
