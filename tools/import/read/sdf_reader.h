#pragma once

#include <filesystem>
#include <string>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Reads a model of SDF 1.5 to 1.9 (sdformat.org) as other programs write it. Poses follow the frames of
// SDF 1.9, and `frame` and `use_parent_model_frame` of the older versions. Elements of other programs are
// lines of `report.ignored`. Throws InputError with the line. Meshes are not opened.
[[nodiscard]] ImportedRobot read_sdf(const std::filesystem::path& file, const std::string& text,
                                     ImportReport& report);

}  // namespace koboshi::tools
