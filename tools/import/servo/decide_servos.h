#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"
#include "tools/import/servo/servo_catalogue.h"

namespace koboshi::tools {

// Decides the servo of each joint: one question for all, with exceptions in `servos`. The preset is the servo
// of usual robots of this mass, or, of a robot too heavy for those of the catalogue, drives as strong as the
// source says, which are added to the catalogue. The other question is whether the ratios of transmissions
// are those of stages behind the servos or of their own gearboxes, which their types include. Only the former
// remain in `reduction`. Effort and speed that the servo does not have are repaired to its own.
void decide_servos(ImportedRobot& robot, ServoCatalogue& catalogue, Interview& interview,
                   ImportReport& report);

}  // namespace koboshi::tools
