#pragma once

#include <filesystem>

#include "sim_board/input/yaml_reader.h"

namespace koboshi::sim {

// Returns the repository of a folder: the folder or its nearest parent that contains robots/ and scenarios/,
// or else the repository from which the program was built.
std::filesystem::path repository_root(const std::filesystem::path& folder);

// Resolves a path that a file in `folder` contains: relative to that folder, then to the repository's root.
// Empty if no such file exists.
std::filesystem::path find_referenced(const std::filesystem::path& folder, const std::filesystem::path& path);

// Resolves a value that is a path. Throws InputError if the file does not exist.
std::filesystem::path read_path(const YamlValue& value, const std::filesystem::path& folder);

}  // namespace koboshi::sim
