#pragma once

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Moves actuators to the joints that they drive. In a model with all its gears and rods, the actuator turns a
// gear or a crank, and the joint of the limb has none: it follows the gear (`mimics`), or a rod closes a loop
// through both. Of two such joints, the one that carries more mass is the limb's and gets the actuator, with
// the ratio of the gears. The ratio of rods is taken as 1, that of a parallelogram, with a warning. A loop
// that moves no actuator is a warning, too.
void move_actuators(ImportedRobot& robot, ImportReport& report);

}  // namespace koboshi::tools
