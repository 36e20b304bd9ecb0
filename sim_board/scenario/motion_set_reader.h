#pragma once

#include <vector>

#include "sim_board/input/yaml_reader.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// Replaces numbers of the motion files by those in `motion_set`. Throws InputError if a file has no such
// number.
void read_motion_set(const YamlMap& root, std::vector<MotionChoice>& motions);

}  // namespace koboshi::sim
