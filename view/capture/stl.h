#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "view/recording/recording.h"

namespace koboshi::view {

// The content of an STL file.
struct StlFile {
  // In the file's unit; corners at the same place are one vertex, and all are finite.
  std::optional<Mesh> mesh{};
  // Why there is no mesh: "a vertex that is no finite number"; empty if there is one.
  std::string fault{};
  bool is_damaged = false;  // an STL file with an error, in contrast to a file of another format
};

// Reads an STL file, binary or ASCII.
[[nodiscard]] StlFile read_stl(const std::filesystem::path& file);

}  // namespace koboshi::view
