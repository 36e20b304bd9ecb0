#pragma once

#include <filesystem>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Reads an MJCF model through MuJoCo: what its compiler makes of defaults, includes and meshes. A child
// process with limits of time and memory loads the file first, so that a model on which MuJoCo crashes is an
// error of that file. Bodies without a joint that hang from the world, such as floors, are left out; equality
// constraints and tendons are lines of `report.warnings`. Surfaces of meshes are set already. Throws
// InputError with MuJoCo's message and its line, and in a build without MuJoCo.
[[nodiscard]] ImportedRobot read_mjcf(const std::filesystem::path& file, const std::string& text,
                                      ImportReport& report);

}  // namespace koboshi::tools
