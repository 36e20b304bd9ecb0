#pragma once

#include "firmware/motion/motion.h"

namespace koboshi::motion {

inline constexpr MotionVerdict kAccepted{};

constexpr MotionVerdict refuse(MotionStatus status, std::size_t index) {
  return {status, static_cast<std::uint16_t>(index)};
}

// Validates the pose groups of a motion, whose table lies within its image: each moves some joints that the
// motion has, no two the same ones, and their poses add up to those of the motion.
MotionVerdict check_groups(const Motion& motion);

// Validates a motion whose pose groups are valid and whose counts agree with the size of its image. Returns
// the first violation found. Sets `main_step_count` to the steps before the first subroutine. Takes at most
// kMaxPoses * joints, and some 10^5 times a step's opcode (flow_check.h).
MotionVerdict check_motion(const Motion& motion, const robot::RobotModel& model,
                           std::uint16_t& main_step_count);

}  // namespace koboshi::motion
