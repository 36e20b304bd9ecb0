#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/yaml/yaml_reader.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Readers of the optional lists of timed items in a scenario file. The results are in order of time. Throw
// InputError. `motions` are the names of the playable motions.
std::vector<Command> read_commands(const YamlMap& root, const std::vector<std::string>& motions);
std::vector<Push> read_pushes(const YamlMap& root);
std::vector<Fault> read_faults(const YamlMap& root);

// Rounds to the nearest microsecond; `time_s` must not be negative.
std::uint64_t to_us(double time_s);

}  // namespace koboshi::simulation
