#pragma once

#include <cstdint>
#include <map>

#include "hal/port/can.h"
#include "sim_board/can/sdo_block_tracker.h"

namespace koboshi::bus {

// Follows the SDO block transfers of a bus: those of each node's first channel, and of the drives' second
// ones.
class SdoBlocks {
 public:
  // Follows the next frame. Returns whether it is a segment of a block: it then has data instead of a
  // command.
  bool follow(const hal::CanFrame& frame);

 private:
  std::map<std::uint16_t, sim_board::SdoBlockTracker> channels_;  // by the identifier of requests
};

}  // namespace koboshi::bus
