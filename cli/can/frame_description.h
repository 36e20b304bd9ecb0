#pragma once

#include <string>

#include "bus/dictionary/network.h"
#include "sim_board/can/foreign_frame.h"

namespace koboshi::cli {

// Describes any frame in words: the service of CANopen, the values of a PDO by the robot's object
// dictionaries, or the format of a foreign frame. Empty for others.
std::string frame_description(const sim_board::BusFrame& frame, const bus::Network& network);

}  // namespace koboshi::cli
