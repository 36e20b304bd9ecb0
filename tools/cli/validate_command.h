#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace koboshi::tools {

// Adds `koboshi validate` to the program. Its callback sets `exit_status`; `command_line` is how the program
// was called, for the page that says how it was made.
void add_validate_command(CLI::App& program, int& exit_status, const std::string& command_line);

}  // namespace koboshi::tools
