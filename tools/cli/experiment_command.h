#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace koboshi::tools {

// Adds `koboshi experiment ...` to the program. `command_line` is how the program was called, for the pages
// that say how they were made.
void add_experiment_command(CLI::App& program, const std::string& command_line);

}  // namespace koboshi::tools
