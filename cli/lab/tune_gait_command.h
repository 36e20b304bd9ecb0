#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `tune-gait` to `koboshi experiment`.
void add_tune_gait_command(CLI::App& experiment);

}  // namespace koboshi::tools
