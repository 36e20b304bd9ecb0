#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Locks the joints that are no driven hinges: sliders and others, those that mimic another, and those without
// an actuator in a file that has some. Gives hinges without a range the widest one. Each is a line of
// `normalised` and, where it is locked, of `taken.locked_deg`. Throws InputError for a slider that
// import.yaml wants as a joint.
void lock_undriven_joints(ImportedRobot& robot, Interview& interview, ImportReport& report);

// Locks the joints that have no place in the firmware's table, such as wrists and grippers, if the user
// agrees: one question for all.
void lock_extra_joints(ImportedRobot& robot, Interview& interview, ImportReport& report);

// Asks for the range of the joints without one that are left, which then are hinges as all others.
void limit_continuous_joints(ImportedRobot& robot, Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
