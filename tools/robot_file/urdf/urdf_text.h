#pragma once

#include <string>

#include "sim_board/description/description.h"

namespace koboshi::tools {

// Returns a URDF of a robot: links with masses, inertias, boxes and meshes, and joints with limits. A link's
// frame is that of the joint that moves it, as URDF has it, with the axes of the link in the robot's file.
// Lengths are rounded to 1 nm, angles to 1e-9 rad. `mesh_prefix` stands before the path of each mesh relative
// to the robot's file, "package://kit/" for ROS. `robot_file` is the text of the robot's file: it becomes the
// last element, <koboshi>, for what URDF cannot say; empty: none.
[[nodiscard]] std::string urdf_text(const sim_board::RobotDescription& robot, const std::string& mesh_prefix,
                                    const std::string& robot_file);

}  // namespace koboshi::tools
