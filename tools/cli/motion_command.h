#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi motion ...` to the program.
void add_motion_command(CLI::App& program);

}  // namespace koboshi::tools
