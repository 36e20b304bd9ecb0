#pragma once

#include <vector>

#include "bus/dictionary/object_dictionary.h"
#include "firmware/app/dictionary.h"
#include "firmware/robot/model.h"

namespace koboshi::bus {

// The kinds of nodes on the robot's bus; each has a product code, an EDS and a chapter of the page.
//
// The controller of a robot has the PDOs and heartbeat consumers of its drives, and its parameters: those of
// the program, which are neutral, or those that the robot's factory has stored.
NodeKind controller_kind(const robot::RobotModel& robot = {}, const app::ControllerValues& values = {});
NodeKind drive_kind();
NodeKind inertial_kind();
NodeKind ankle_kind(hal::AnkleKind kind = hal::AnkleKind::kSixAxis);  // not for AnkleKind::kNone

// All of them: "controller", "drive", "inertial", "ankle", "cells", "switch".
std::vector<NodeKind> documented_kinds(const robot::RobotModel& robot,
                                       const app::ControllerValues& values = {});

}  // namespace koboshi::bus
