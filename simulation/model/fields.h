#pragma once

#include "firmware/robot/model.h"
#include "sim_board/robot/description.h"

namespace koboshi::simulation {

// Returns the fields of the robot model as stored in its image, except `id` and `order`, which reading sets.
// Throws sim::InputError.
[[nodiscard]] robot::RobotModel model_fields(const sim::RobotDescription& robot);

}  // namespace koboshi::simulation
