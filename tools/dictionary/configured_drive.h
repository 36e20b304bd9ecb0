#pragma once

#include <cstdint>
#include <vector>

#include "firmware/canopen/pdo.h"
#include "firmware/robot/model.h"
#include "sim_board/robot/description.h"

namespace koboshi::tools {

struct ConfiguredDrive {
  // One SDO request of the start-up.
  struct Write {
    canopen::ObjectAddress address;
    std::int64_t value = 0;  // signed where the object is
  };

  std::vector<canopen::PdoConfiguration> rpdos;  // those that are in use
  std::vector<canopen::PdoConfiguration> tpdos;
  std::uint16_t heartbeat_ms = 0;
  std::vector<Write> writes;  // in the order in which the firmware makes them
};

// What a drive has been told when the controller starts it. The firmware's own configuration writes to the
// drive's own node here; nothing repeats its steps. Throws std::logic_error if it fails.
ConfiguredDrive configure_drive(const robot::Joint& joint, const sim::DriveDescription& drive);

}  // namespace koboshi::tools
