#pragma once

#include <filesystem>
#include <string>

#include "base/yaml/yaml_tree.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Returns duration, commands and pushes in the format of a scenario file. Reading them back gives the same
// times to the microsecond and the same pushes to the bit.
std::string events_text(const Scenario& scenario);

// Returns a scenario file that repeats a run when placed in `folder`: the scenario's document with duration,
// commands and pushes of `played`, and without an operator.
std::string played_text(const Scenario& played, const std::filesystem::path& folder);

// Returns a scenario's document with its file names relative to another folder. Names that are found from any
// folder, such as `koboshi`, stay.
YamlNode with_moved_files(YamlNode document, const std::filesystem::path& from,
                          const std::filesystem::path& to);

}  // namespace koboshi::simulation
