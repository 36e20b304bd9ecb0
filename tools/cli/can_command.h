#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

void add_can_command(CLI::App& program);

}  // namespace koboshi::tools
