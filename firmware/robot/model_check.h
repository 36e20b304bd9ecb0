#pragma once

#include "firmware/robot/model.h"

namespace koboshi::robot {

// Validates the fields of a model and computes `order`. Returns the first violation found; `order` is then
// undefined. Requires joint_count <= kMaxJoints.
[[gnu::cold]] ModelStatus check_model(RobotModel& model);

}  // namespace koboshi::robot
