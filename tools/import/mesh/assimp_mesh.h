#pragma once

#include <filesystem>

#include "tools/import/mesh/mesh_reader.h"

namespace koboshi::tools {

// Reads a file by Assimp in a child process of at most 5 s of processor time and 2 GiB of memory. The unit
// and the upward axis that a Collada file names are applied. Must be called in a process with one thread.
[[nodiscard]] MeshFile read_by_assimp(const std::filesystem::path& file);

}  // namespace koboshi::tools
