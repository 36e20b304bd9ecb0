#pragma once

#include <string>

#include "sim_board/robot/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// No push or torque of a real scenario comes near; far beyond it an engine's own arithmetic overflows inside
// a step.
inline constexpr double kLargestForce = 1e6;  // N or N m

// Ends a run, with its time: `what` (a body, a joint, a library) and the reason. Throws WorldBlewUp.
[[noreturn]] void blow_up(double time_s, const std::string& what, const std::string& reason);

// They blow up on what is beyond the limits or not a finite number.
void check_servo(double time_s, const JointDescription& joint, const ServoTorque& servo);
void check_push(double time_s, const LinkDescription& link, const Eigen::Vector3d& p_L,
                const Eigen::Vector3d& f_W);
// Not finite, or faster than the options bear.
void check_body(double time_s, const LinkDescription& link, const WorldOptions& options,
                const Eigen::Isometry3d& X, const Eigen::Vector3d& v_W, const Eigen::Vector3d& w_W);

}  // namespace koboshi::sim
