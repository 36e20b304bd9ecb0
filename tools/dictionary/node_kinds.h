#pragma once

#include <vector>

#include "tools/dictionary/object_dictionary.h"

namespace koboshi::tools {

// The kinds of nodes on the robot's bus. An inertial unit and an ankle's sensor share one table and one EDS;
// they differ in what their PDOs carry after a reset.
NodeKind controller_kind();
NodeKind drive_kind();
NodeKind inertial_kind();
NodeKind ankle_kind();

// What has an EDS and a chapter of the page: controller, drive, sensor.
std::vector<NodeKind> documented_kinds();

}  // namespace koboshi::tools
