#pragma once

#include <string>

#include "sim_board/robot/description.h"
#include "tools/gait/gait.h"
#include "tools/gait/gait_plan.h"
#include "tools/model/robot_model.h"
#include "tools/motion/source.h"

namespace koboshi::tools {

// The walk as a motion: the plan divided into points, each a pose by inverse kinematics, between which the
// firmware interpolates linearly (the paper's figure 6). Begins by standing, repeats the cycle until it is
// stopped. Throws sim::InputError, naming the gait's file, where a leg does not reach or a joint's limit is
// in the way.
[[nodiscard]] MotionSource make_gait_motion(const Gait& gait, const sim::RobotDescription& robot,
                                            const NamedModel& model);

// The motion file of it: what parse_motion makes a MotionSource of with the same poses.
[[nodiscard]] std::string gait_motion_text(const MotionSource& motion, const NamedModel& model);

}  // namespace koboshi::tools
