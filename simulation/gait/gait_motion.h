#pragma once

#include <string>

#include "sim_board/robot/description.h"
#include "simulation/gait/gait.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// The walk as a motion: the plan divided into points, each a pose by inverse kinematics, between which the
// firmware interpolates linearly (the paper's figure 6). Begins by standing, repeats the cycle until it is
// stopped. Throws sim::InputError, naming the gait's file, where a leg does not reach or a joint's limit is
// in the way.
[[nodiscard]] MotionSource make_gait_motion(const Gait& gait, const sim::RobotDescription& robot,
                                            const NamedModel& model);

// The motion file of it: what parse_motion makes a MotionSource of with the same poses.
[[nodiscard]] std::string gait_motion_text(const MotionSource& motion, const NamedModel& model);

}  // namespace koboshi::simulation
