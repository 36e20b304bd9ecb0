#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bus/can/device_file.h"
#include "bus/can/sdo_transfer.h"

namespace koboshi::bus {

// The objects of a node against those of a device file.
struct ConfigurationReport {
  std::size_t compared = 0;
  std::size_t written = 0;
  std::size_t left_out = 0;              // without a value, write-only, domains
  std::vector<std::string> differences;  // a line for each object that differs or cannot be accessed
};

// Compares the value of each object of the file that is readable and has one: of a DCF its ParameterValues,
// of an EDS its DefaultValues. Throws std::runtime_error if the node does not answer.
ConfigurationReport compare_configuration(SdoTransfer& sdo, const DeviceFile& file);

// Writes the ParameterValues of a DCF that the node has not yet, then compares. Objects that CiA 301 locks
// while they are in use are released first, all of them, and used again last: PDOs and their mappings, the
// COB-IDs of SYNC, TIME, EMCY and SDO, heartbeat consumers, and the SYNC period before 1019. The record 1020
// comes after all others. 1010 and 1011, which store and restore parameters, and the SDO channel in use are
// not written.
ConfigurationReport write_configuration(SdoTransfer& sdo, const DeviceFile& file);

}  // namespace koboshi::bus
