#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim_board/input/yaml_tree.h"

namespace koboshi::tools {

// What the command line sets in a file: each KEY=VALUE of --set, then the options that stand for a key, but
// for those without a value. Throws sim::InputError.
std::vector<sim::Override> overrides_of(std::span<const std::string> sets,
                                        const std::vector<sim::Override>& options);

}  // namespace koboshi::tools
