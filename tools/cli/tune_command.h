#pragma once

#include <CLI/CLI.hpp>

namespace koboshi::tools {

// koboshi tune STUDY.yaml
void add_tune_command(CLI::App& program);

}  // namespace koboshi::tools
