#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim_board/input/yaml_reader.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// The lists of a scenario file whose items have a time. Each may be missing; the results are in the order of
// time. Throw InputError. `motions` are the names of those that can be played.
std::vector<Command> read_commands(const YamlMap& root, const std::vector<std::string>& motions);
std::vector<Push> read_pushes(const YamlMap& root);
std::vector<Fault> read_faults(const YamlMap& root);

// The nearest whole number of microseconds; `time_s` is not negative.
std::uint64_t to_us(double time_s);

}  // namespace koboshi::sim
