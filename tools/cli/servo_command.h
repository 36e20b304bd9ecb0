#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// Adds `koboshi servo plot` and `koboshi servo from-datasheet` to the program.
void add_servo_command(CLI::App& program);

}  // namespace koboshi::tools
