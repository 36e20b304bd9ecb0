#pragma once

#include <filesystem>

#include "sim_board/robot/description.h"

namespace koboshi::sim {

// Reads a robot from an SDF 1.9 file (the part of it that sdf_schema.cc names). Meshes are relative to the
// file. Throws InputError, with the line, where the file is missing, malformed or describes no robot that can
// be simulated: inertias of no rigid body, axes that are no unit vectors, empty ranges, collisions that are
// no boxes, joints that are no hinges or do not make one tree of all links, node ids or names used twice,
// meshes that are not there.
RobotDescription load_robot(const std::filesystem::path& file);

}  // namespace koboshi::sim
