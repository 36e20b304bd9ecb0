#pragma once

#include <string>

#include "sim_board/description/description.h"
#include "simulation/gait/gait.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Makes a motion from a gait: samples the plan, computes each pose by inverse kinematics, and leaves linear
// interpolation between the poses to the firmware (the paper's figure 6). The motion begins in the standing
// pose and repeats the cycle until it is stopped. Throws InputError with the gait's file if a pose is
// out of a leg's reach or violates a joint limit.
[[nodiscard]] MotionSource make_gait_motion(const Gait& gait, const sim_board::RobotDescription& robot,
                                            const NamedModel& model);

// Returns the motion as the text of a motion file. parse_motion reads it back with the same poses.
[[nodiscard]] std::string gait_motion_text(const MotionSource& motion, const NamedModel& model);

}  // namespace koboshi::simulation
