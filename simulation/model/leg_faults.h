#pragma once

#include <vector>

#include "base/text/error.h"
#include "firmware/robot/model.h"
#include "sim_board/description/description.h"

namespace koboshi::simulation {

// Appends an error for each property of the legs that the firmware's inverse kinematics cannot serve
// (robot::make_leg_geometry): which joint, by how much, and what it has to be. `model`: the fields of this
// robot's model. No errors are appended if and only if the firmware accepts both legs.
void find_leg_faults(const sim_board::RobotDescription& robot, const robot::RobotModel& model,
                     std::vector<InputError>& errors);

}  // namespace koboshi::simulation
