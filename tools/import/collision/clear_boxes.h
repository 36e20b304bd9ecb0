#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Shrinks the boxes of an aligned robot until none touch in the zero pose and while each joint alone turns
// through its usual range, and ends the joints' ranges where boxes meet beyond that (a repair): limits wider
// than the geometry allows. Pairs of links with fewer than three joints between them never make contacts and
// are left out. Feet keep their soles. What touches anyway is a warning.
void clear_boxes(ImportedRobot& robot, Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
