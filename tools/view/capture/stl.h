#pragma once

#include <filesystem>
#include <optional>

#include "tools/view/recording/recording.h"

namespace koboshi::view {

// Reads a binary STL file: a mesh in the file's unit, in which corners at the same place are one vertex.
// Nothing for a file of another format.
std::optional<Mesh> read_stl(const std::filesystem::path& file);

}  // namespace koboshi::view
