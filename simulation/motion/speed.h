#pragma once

#include "simulation/model/robot_model.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// Throws sim::InputError at the first move that asks a joint for more than its speed, as far as the joint's
// angle before the move is known: not before its first pose, and not behind a label.
void check_speeds(const MotionSource& motion, const NamedModel& robot);

}  // namespace koboshi::simulation
