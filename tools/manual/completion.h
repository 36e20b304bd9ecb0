#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace koboshi::tools {

// Returns the completion of the program for bash, from the same table as `--help`: commands, options and
// their values, and the names of scenarios, robots, motions and studies, which it asks of
// `koboshi manual names`.
[[nodiscard]] std::string bash_completion(const CLI::App& program);

}  // namespace koboshi::tools
