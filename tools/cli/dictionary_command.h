#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi dictionary ...` to the program.
void add_dictionary_command(CLI::App& program);

}  // namespace koboshi::tools
