#pragma once

#include <string>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"
#include "tools/import/write/robot_sdf.h"

namespace koboshi::tools {

// Returns import.md: what the import found, changed and asked. `command` is the command line to repeat it.
[[nodiscard]] std::string import_page(const ImportedRobot& robot, const RobotFileParts& parts,
                                      const Interview& interview, const ImportReport& report,
                                      const std::string& command);

}  // namespace koboshi::tools
