#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::cli {

// Adds `tune-gait` to `koboshi experiment`.
void add_tune_gait_command(CLI::App& experiment);

}  // namespace koboshi::cli
