#pragma once

#include <filesystem>
#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::tools {

// Draws the robot once for each joint, turned by 20 degrees, with the links that it moves in orange:
// FOLDER/JOINT.png. A joint whose range ends before turns the other way. Returns the files. Throws
// WriteError and view::GlError.
std::vector<std::filesystem::path> draw_joint_pictures(const sim_board::RobotDescription& robot,
                                                       const std::filesystem::path& folder);

// Draws the robot at joint angles zero into a PNG file: what is seen of it, or its collision boxes. Throws
// WriteError and view::GlError.
enum class RobotShapes { kVisuals, kCollisions };
void draw_robot(const sim_board::RobotDescription& robot, RobotShapes shapes,
                const std::filesystem::path& file);

}  // namespace koboshi::tools
