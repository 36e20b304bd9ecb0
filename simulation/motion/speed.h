#pragma once

#include "simulation/model/robot_model.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// Checks that no move exceeds a joint's speed limit. A joint's first move and its moves directly after a
// label are not checked, because the initial angle is unknown. Throws sim::InputError at the first violation.
void check_speeds(const MotionSource& motion, const NamedModel& robot);

}  // namespace koboshi::simulation
