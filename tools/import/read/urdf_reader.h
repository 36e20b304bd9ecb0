#pragma once

#include <filesystem>
#include <string>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Reads a URDF (wiki.ros.org/urdf/XML). Elements of other programs are lines of `report.ignored`. Throws
// InputError with the line for what URDF does not permit. Meshes are not opened.
[[nodiscard]] ImportedRobot read_urdf(const std::filesystem::path& file, const std::string& text,
                                      ImportReport& report);

}  // namespace koboshi::tools
