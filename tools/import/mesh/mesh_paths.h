#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace koboshi::tools {

// Finds the files that a robot's file names: by a path relative to it, file://, package://PACKAGE/PATH and
// model://MODEL/PATH.
class MeshPaths {
 public:
  // `folders`: those of --path, searched first. The folders of ROS_PACKAGE_PATH, GAZEBO_MODEL_PATH and
  // AMENT_PREFIX_PATH follow, then the folder of the robot's file and those above it.
  MeshPaths(const std::filesystem::path& robot_file, const std::vector<std::filesystem::path>& folders);

  // Returns the file, or an empty path if there is none.
  [[nodiscard]] std::filesystem::path find(const std::string& uri) const;
  // Returns the file below these folders with the same end of its path, as long as possible, whatever the
  // case of its letters; empty without one. For paths of another machine: C:\\kit\\meshes\\trunk.STL.
  [[nodiscard]] std::filesystem::path find_by_end(const std::string& uri) const;

 private:
  std::filesystem::path folder_;                 // of the robot's file
  std::vector<std::filesystem::path> packages_;  // folders that contain packages, or are one
};

}  // namespace koboshi::tools
