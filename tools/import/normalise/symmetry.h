#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Compares left and right of an aligned robot, and makes them mirror images if the user agrees: masses,
// centres of mass, inertias and ranges of the joints. Both sides get the centre of mass that is nearer to the
// middle of its shape. Also moves the centre of mass of the trunk and the head to the mid-plane.
// Each difference is a repair.
void repair_symmetry(ImportedRobot& robot, Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
