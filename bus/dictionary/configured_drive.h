#pragma once

#include <cstdint>
#include <vector>

#include "firmware/canopen/pdo.h"
#include "firmware/robot/model.h"
#include "sim_board/description/description.h"

namespace koboshi::bus {

struct ConfiguredDrive {
  // One SDO request of the start-up.
  struct Write {
    canopen::ObjectAddress address;
    std::int64_t value = 0;  // signed where the object is
  };

  std::vector<canopen::PdoConfiguration> rpdos;  // PDOs in use
  std::vector<canopen::PdoConfiguration> tpdos;
  std::uint16_t heartbeat_ms = 0;
  std::vector<Write> writes;  // in the order in which the firmware makes them
};

// Returns the state of a drive after the controller has configured it: runs the firmware's configuration
// against the drive's CANopen node. Throws std::logic_error if it fails.
ConfiguredDrive configure_drive(const robot::Joint& joint, const sim_board::DriveDescription& drive);

}  // namespace koboshi::bus
