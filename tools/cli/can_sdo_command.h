#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

void add_can_sdo_command(CLI::App& can);

}  // namespace koboshi::tools
