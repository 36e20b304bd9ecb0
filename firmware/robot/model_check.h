#pragma once

#include "firmware/robot/model.h"

namespace koboshi::robot {

// Validates a model whose fields were read, and fills in `order`. The first reason found.
ModelStatus check_model(RobotModel& model);

}  // namespace koboshi::robot
