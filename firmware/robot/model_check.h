#pragma once

#include "firmware/robot/model.h"

namespace koboshi::robot {

// Validates the fields of a model and computes `order`. Returns the first violation found.
ModelStatus check_model(RobotModel& model);

}  // namespace koboshi::robot
