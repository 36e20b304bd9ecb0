#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi gait` to the program.
void add_gait_command(CLI::App& program);

}  // namespace koboshi::tools
