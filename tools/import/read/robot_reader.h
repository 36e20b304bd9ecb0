#pragma once

#include <filesystem>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Reads a robot of any known format, by the root element of the file. Throws InputError, also for a joint
// that closes a loop.
[[nodiscard]] ImportedRobot read_foreign_robot(const std::filesystem::path& file, ImportReport& report);

}  // namespace koboshi::tools
