#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace koboshi::tools {

// Returns the path of a file relative to a folder that contains it; empty for a file outside of it.
[[nodiscard]] std::filesystem::path path_in_folder(const std::filesystem::path& file,
                                                   const std::filesystem::path& folder);

// Writes a robot's file as a URDF, which holds a copy of that file (urdf_text.h) with all servo types in it,
// and copies the meshes into the folder of the URDF, with the same relative paths, and the licence. `package`
// is the ROS package of that folder; empty: the paths of the meshes are relative. Returns the files that were
// written. Throws InputError for a robot that does not load, or a mesh outside of its folder, and WriteError.
std::vector<std::filesystem::path> export_urdf(const std::filesystem::path& robot_file,
                                               const std::filesystem::path& urdf, const std::string& package);

}  // namespace koboshi::tools
