#pragma once

#include <vector>

#include "base/yaml/yaml_reader.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Replaces numbers of the motion files by those in `motion_set`. Throws InputError if a file has no such
// number.
void read_motion_set(const YamlMap& root, std::vector<MotionChoice>& motions);

}  // namespace koboshi::simulation
