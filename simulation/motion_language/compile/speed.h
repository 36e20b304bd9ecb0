#pragma once

#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Checks that no move exceeds a joint's speed limit, with the peak speed of its interpolation. A joint's
// moves are not checked where its angle before is unknown: the first one, and those directly after a label, a
// call, or branches that end in different poses. A move with a least time takes the time that its joints
// need.
void check_speeds(const MotionSource& motion, const NamedModel& robot, Diagnostics& diagnostics);

}  // namespace koboshi::simulation
