#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "view/recording/recording.h"

namespace koboshi::tools {

struct MeshFile {
  std::optional<view::Mesh> mesh{};  // in the file's unit, or in m where the file names its unit; z up
  std::string fault{};               // why there is none
};

// Reads an STL file (binary or ASCII), or a Collada (DAE) or Wavefront (OBJ) file by Assimp. Assimp runs in a
// child process with limits of time and memory, so that a file on which it fails is a fault of that file
// only.
[[nodiscard]] MeshFile read_mesh_file(const std::filesystem::path& file);

}  // namespace koboshi::tools
