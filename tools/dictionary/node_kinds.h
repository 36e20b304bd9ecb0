#pragma once

#include <vector>

#include "firmware/robot/model.h"
#include "tools/dictionary/object_dictionary.h"

namespace koboshi::tools {

// The kinds of nodes on the robot's bus; each has a product code, an EDS and a chapter of the page.
NodeKind controller_kind(const robot::RobotModel& robot = {});  // with PDOs and consumers of its drives
NodeKind drive_kind();
NodeKind inertial_kind();
NodeKind ankle_kind();

// All of them: "controller", "drive", "inertial", "ankle".
std::vector<NodeKind> documented_kinds(const robot::RobotModel& robot);

}  // namespace koboshi::tools
