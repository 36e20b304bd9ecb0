#pragma once

#include <functional>
#include <string>

#include "firmware/canopen/dictionary.h"

namespace koboshi::bus {

// Returns a function that names the objects of the nodes on a robot's bus by their dictionaries; empty for an
// object that the node has not. Controller and sensors have fixed nodes, and every other node is a drive.
std::function<std::string(int node, canopen::ObjectAddress address)> object_names();

}  // namespace koboshi::bus
