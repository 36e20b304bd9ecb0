#pragma once

#include <string>

#include "sim_board/robot/description.h"

namespace koboshi::tools {

// The configuration of a CANopen master that takes the controller's place, in the format of dcfgen (the tools
// of lely-core): the master's own cycle and heartbeat, and for each drive and sensor its data sheet,
// identity, supervision, PDOs and the SDO requests of its start-up. A drive is configured as by the firmware.
// Throws sim::InputError as make_network does.
std::string bus_text(const sim::RobotDescription& robot);

}  // namespace koboshi::tools
