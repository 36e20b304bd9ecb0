#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

void add_firmware_command(CLI::App& program);

}  // namespace koboshi::tools
