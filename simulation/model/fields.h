#pragma once

#include "firmware/robot/model.h"
#include "sim_board/robot/description.h"

namespace koboshi::simulation {

// The fields of the robot's model as they go into its image; `id` and `order` come from reading it. Throws
// sim::InputError.
[[nodiscard]] robot::RobotModel model_fields(const sim::RobotDescription& robot);

}  // namespace koboshi::simulation
