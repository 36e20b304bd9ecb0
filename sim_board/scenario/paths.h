#pragma once

#include <filesystem>

#include "sim_board/input/yaml_reader.h"

namespace koboshi::sim {

// The repository that a folder belongs to: the folder itself or the nearest one above it that holds robots/
// and scenarios/; failing that, the one that the program was built from.
std::filesystem::path repository_root(const std::filesystem::path& folder);

// The file that `path` means where a file in `folder` names it: relative to that folder, then to the
// repository's root. Empty if there is none.
std::filesystem::path find_referenced(const std::filesystem::path& folder, const std::filesystem::path& path);

// The same for a value that is a path. Throws InputError if there is no such file.
std::filesystem::path read_path(const YamlValue& value, const std::filesystem::path& folder);

}  // namespace koboshi::sim
