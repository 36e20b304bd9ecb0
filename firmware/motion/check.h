#pragma once

#include "firmware/motion/motion.h"

namespace koboshi::motion {

// Validates a motion whose counts agree with the image's size. The first reason found. Its work is bounded by
// kMaxPoses * joints + kMaxSteps * (kMaxJumps + kMaxZeroTimeSteps) look-ups.
MotionVerdict check_motion(const Motion& motion, const robot::RobotModel& model);

}  // namespace koboshi::motion
