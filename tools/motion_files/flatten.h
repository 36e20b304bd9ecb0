#pragma once

#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"
#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// Turns a motion of the motion language into key frames of one section, with the robot's joints in rad: loops
// are repeated, times of moves by speed and paths of the zero moment point computed; declared leans are kept.
// Notes what key frames cannot say and is left out: attitudes that are expected, corrections, gains,
// stiffness other than 0, the interpolation. Throws InputError with the line for a program that depends on
// sensors, variables or a stop command, and for one of more than 10,000 frames.
[[nodiscard]] ForeignMotion flatten_motion(const simulation::MotionSource& source,
                                           const simulation::NamedModel& robot);

}  // namespace koboshi::tools
