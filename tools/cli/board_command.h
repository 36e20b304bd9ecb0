#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

void add_board_command(CLI::App& program);

}  // namespace koboshi::tools
