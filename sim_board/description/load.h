#pragma once

#include <filesystem>
#include <string>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// Reads a robot from a file of SDF 1.5 to 1.9 (the subset in docs/reference/robot-file.md). Mesh paths are
// relative to the file. Throws InputError, with the line, if the file is missing or malformed or cannot be
// simulated: inertias of no rigid body, axes that are not unit vectors, empty ranges, collisions that are not
// boxes, joints that are not hinges or do not form one tree of all links, frames that are missing or form a
// ring, duplicate node ids or names, missing meshes.
RobotDescription load_robot(const std::filesystem::path& file);
// Reads a text instead of the file's, such as one that is being edited. Paths in it and errors are as in the
// file.
RobotDescription load_robot(const std::filesystem::path& file, const std::string& text);

}  // namespace koboshi::sim_board
