#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Shrinks the boxes of an aligned robot until none touch in the zero pose and while each joint alone turns
// through its usual range, and ends the joints' ranges where boxes meet beyond that (a repair): limits wider
// than the geometry allows. Pairs of links with fewer than three joints between them never make contacts and
// are left out. Boxes of the leg above a foot are cut so that they stay above its sole, however the ankle
// turns. Boxes of different limbs are kept apart in squats with hanging arms (bent_legs.h). Feet keep their
// soles. Boxes that touch nevertheless are a warning.
void clear_boxes(ImportedRobot& robot, Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
