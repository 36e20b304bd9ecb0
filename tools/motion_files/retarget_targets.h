#pragma once

#include <filesystem>

#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// A robot's file, and what the firmware knows of it.
struct RetargetRobot {
  const sim_board::RobotDescription& description;
  const simulation::NamedModel& model;
};

// Makes of a motion of robot `from`, as flatten_motion() returns it, one of `to` with the same key frames and
// times, whose joints are those of `to` in their order. In each frame the soles, the trunk, the centre of
// mass and the hands are where they are on `from`, in lengths of the robot:
//   - distances of feet and hips by the length of the legs, the distance of parallel feet by that of the
//   hips;
//   - the centre of mass within the rectangle that the feet which carry span;
//   - hands relative to the shoulders, by the length of the arms;
//   - the orientations of trunk and soles as they are.
// The feet that carry are both if their soles lie in one plane, else the one to which the centre of mass is
// closer. Legs and arms that the motion has not moved so far stay without angles. Where the legs do not
// reach, the hips are lowered, by at most a fifth. All other joints have the angle of the joint with the same
// role, as in retarget_joints(). So has a whole frame in which the robot does not stand on its soles, such as
// one that lies. Notes say what was lowered, not reached and lying, by frame. Throws InputError, naming
// `file`, as retarget_joints(), and if a robot has no legs.
[[nodiscard]] ForeignMotion retarget_targets(const std::filesystem::path& file, const ForeignMotion& motion,
                                             const RetargetRobot& from, const RetargetRobot& to);

}  // namespace koboshi::tools
