#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace koboshi::tools {

// Adds the experiments on falling and getting up to `koboshi experiment`.
void add_recovery_experiments(CLI::App& experiment, const std::string& command_line);

}  // namespace koboshi::tools
