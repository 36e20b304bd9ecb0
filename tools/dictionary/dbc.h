#pragma once

#include <string>

#include "tools/dictionary/network.h"

namespace koboshi::tools {

// A network in the format of Vector's CANdb++, which most programs for CAN read.
std::string dbc_text(const Network& network);

}  // namespace koboshi::tools
