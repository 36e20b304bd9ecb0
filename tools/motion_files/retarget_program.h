#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/parse.h"
#include "tools/motion_files/convert.h"
#include "tools/motion_files/retarget_targets.h"

namespace koboshi::tools {

// A motion file of another robot, and what was changed on the way, one sentence each.
struct RetargetedMotion {
  std::string text;
  std::vector<std::string> report;
  std::size_t too_fast = 0;   // moves that the servos cannot do in their time
  std::size_t stretched = 0;  // of these, which were given more time
};

// Turns a motion of robot `from` into one of `to` that runs the same program: loops, conditions, routines,
// variables, expected attitudes, interpolations and comments stay as they are written. Each pose becomes the
// joint angles of `to`, by roles or, with `by_targets`, by retarget_targets(); a pose of all joints stays one
// of all joints. Joints in settings, corrections and conditions become those with the same role. A joint that
// `to` lacks is left out of poses and settings, a step that then sets nothing is removed, and a move that
// then moves nothing is a wait. With options.retime, moves that are too fast get more time, their parts for
// single joints in proportion. Throws InputError, naming the file, as retarget_joints() and
// retarget_targets(), for a condition about a joint that `to` lacks, and for a move of more than 60 s.
[[nodiscard]] RetargetedMotion retarget_program(const simulation::MotionFile& file, const RetargetRobot& from,
                                                const RetargetRobot& to, bool by_targets,
                                                const ConversionOptions& options = {});

// Gives the move at this place of the text `factor` times its time, or divides its speed by it. Leaves a move
// with a least time, and other steps, as they are. Throws InputError, naming `file`, for a move
// of more than 60 s.
void slow_down_move(RetargetedMotion& motion, const std::filesystem::path& file,
                    const simulation::NamedModel& robot, int line, int column, double factor);

}  // namespace koboshi::tools
