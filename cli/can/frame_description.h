#pragma once

#include <map>
#include <string>

#include "bus/can/sdo_blocks.h"
#include "bus/can/source.h"
#include "bus/dictionary/network.h"
#include "sim_board/can/foreign_frame.h"

namespace koboshi::cli {

// Describes any frame in words: the service of CANopen, the values of a PDO by the robot's object
// dictionaries, or the format of a foreign frame. `is_segment`: as of FollowedBlocks. Empty for others.
std::string frame_description(const sim_board::BusFrame& frame, const bus::Network& network, bool is_segment);

// Follows the SDO block transfers of each interface of a source.
class FollowedBlocks {
 public:
  // Follows the next frame; returns whether it is a segment of an SDO block.
  bool follow(const bus::TimedFrame& timed);

 private:
  std::map<std::string, bus::SdoBlocks> interfaces_;
};

}  // namespace koboshi::cli
