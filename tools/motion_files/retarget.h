#pragma once

#include <filesystem>

#include "sim_board/description/description.h"
#include "tools/motion_files/format/foreign_motion.h"
#include "tools/motion_files/joint_map.h"

namespace koboshi::tools {

// Finds for each joint of a motion of robot `from`, as flatten_motion() returns it, the joint of `to` with
// the same role (sim_board/description/roles.h). A joint whose axis points the other way at joint angles zero
// turns with the opposite sign; zero angles are those of both robots' files. Joints that `to` does not have
// are dropped and noted. Throws InputError, naming `file`, if a leg's joint that moves is among them, unless
// the legs have targets, and if axes of a role are more than 45 degrees apart: the angles then mean something
// else.
[[nodiscard]] JointMap retarget_joints(const std::filesystem::path& file, const ForeignMotion& motion,
                                       const sim_board::RobotDescription& from,
                                       const sim_board::RobotDescription& to, bool legs_have_targets = false);

}  // namespace koboshi::tools
