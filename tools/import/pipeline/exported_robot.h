#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/import/robot/report.h"

namespace koboshi::tools {

// A URDF that `koboshi model export` wrote. It holds the robot's file, and another program may have changed
// values of the URDF since.
struct ExportedRobot {
  std::string robot_file{};  // its text
  int line = 0;              // in the URDF
};

// Returns the robot's file in a URDF; nothing for another file.
[[nodiscard]] std::optional<ExportedRobot> find_exported_robot(const std::filesystem::path& file);

// Brings masses, centres of mass, inertias and limits that differ in the URDF into the robot's file, each as
// a line of `normalised`. Returns the resulting text. Returns nothing, with a warning, if the robot's file
// does not load or needs other files than meshes below the folder of the URDF, or if the URDF differs in
// another way: it then is another robot.
[[nodiscard]] std::optional<std::string> updated_robot_file(const std::filesystem::path& file,
                                                            const ExportedRobot& exported,
                                                            ImportReport& report);

}  // namespace koboshi::tools
