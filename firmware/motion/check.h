#pragma once

#include "firmware/motion/motion.h"

namespace koboshi::motion {

// Validates a motion whose counts agree with the size of its image. Returns the first violation found. Takes
// at most kMaxPoses * joints + kMaxSteps * (kMaxJumps + kMaxZeroTimeSteps) look-ups.
MotionVerdict check_motion(const Motion& motion, const robot::RobotModel& model);

}  // namespace koboshi::motion
