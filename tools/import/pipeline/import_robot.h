#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"
#include "tools/import/write/robot_folder.h"

namespace koboshi::tools {

struct ImportOptions {
  std::filesystem::path file{};                // URDF, SDF or MJCF
  std::vector<std::filesystem::path> paths{};  // in which meshes are searched
  std::filesystem::path servo_folder{};        // libraries of servo types
  std::filesystem::path decisions_source{};    // named in messages about answers
  ImportDecisions decisions{};                 // given by files and options
  Interview::Ask ask{};                        // asks a person; empty: presets
  std::filesystem::path output{};              // the robot's folder, to which the source is written relative
  std::string command{};                       // for import.md
};

struct ImportResult {
  ImportedRobot robot{};  // aligned and repaired
  ImportReport report{};
  FolderFiles files{};  // robot.sdf, import.yaml, import.md, meshes and licences
  std::size_t questions = 0;
};

// Returns the path of the source relative to the robot's folder, for readers of import.yaml.
[[nodiscard]] std::filesystem::path relative_source(const ImportOptions& options);

// Imports a robot without writing a file. Throws InputError.
[[nodiscard]] ImportResult import_robot(const ImportOptions& options);

}  // namespace koboshi::tools
