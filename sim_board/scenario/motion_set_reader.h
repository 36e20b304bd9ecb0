#pragma once

#include <vector>

#include "sim_board/input/yaml_reader.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// Gives the motions the numbers that `motion_set` has for them instead of what their files say. Throws
// InputError where a file has no such number.
void read_motion_set(const YamlMap& root, std::vector<MotionChoice>& motions);

}  // namespace koboshi::sim
