#pragma once

#include "cli/options.h"

namespace koboshi::cli {

// Prints number, name and CRC-32 of each motion that the robot on this bus can play. Returns the exit status.
int list_on_robot(const CanOptions& can);

}  // namespace koboshi::cli
