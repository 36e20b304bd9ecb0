#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi diff` to the program. Its callback sets `exit_status`.
void add_diff_command(CLI::App& program, int& exit_status);

}  // namespace koboshi::tools
