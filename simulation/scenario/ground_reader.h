#pragma once

#include <filesystem>
#include <vector>

#include "base/yaml/yaml_reader.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Reads the optional keys `ground` and `materials` of a scenario file. File names are relative to `folder`,
// as in read_path(). Throws InputError.
Ground read_ground(const YamlMap& root, const std::filesystem::path& folder);
std::vector<NamedMaterialPair> read_materials(const YamlMap& root);
// Reads the balls and boxes beside the robot, whose names differ.
std::vector<FreeBody> read_bodies(const YamlMap& root);

}  // namespace koboshi::simulation
