#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi run` to the program. Its callback sets `exit_status`.
void add_run_command(CLI::App& program, int& exit_status);

}  // namespace koboshi::tools
