#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace koboshi::tools {

// Adds the experiments on walking by command to `koboshi experiment`.
void add_walking_experiments(CLI::App& experiment, const std::string& command_line);

}  // namespace koboshi::tools
