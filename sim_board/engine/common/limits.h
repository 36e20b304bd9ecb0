#pragma once

#include <string>

#include "sim_board/description/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Bound of forces and torques, far above those of any real scenario. Much larger values overflow the engines'
// arithmetic within a step.
inline constexpr double kMaxForce = 1e6;  // N or N m

// Ends a run by throwing WorldBlewUp with the time, `what` (a body, a joint, a library) and the reason.
[[noreturn]] void blow_up(double time_s, const std::string& what, const std::string& reason);

// The checks call blow_up for a value that is not finite or beyond the limits.
void check_servo(double time_s, const JointDescription& joint, const ServoTorque& servo);
void check_push(double time_s, const LinkDescription& link, const Eigen::Vector3d& p_L,
                const Eigen::Vector3d& f_W);
// Checks that the body's state is finite and its speed within the options' limit.
void check_body(double time_s, const LinkDescription& link, const WorldOptions& options,
                const Eigen::Isometry3d& X, const Eigen::Vector3d& v_W, const Eigen::Vector3d& w_W);

}  // namespace koboshi::sim_board
