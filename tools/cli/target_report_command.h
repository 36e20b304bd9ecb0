#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi target-report` to the program.
void add_target_report_command(CLI::App& program);

}  // namespace koboshi::tools
