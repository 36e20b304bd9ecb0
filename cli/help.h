#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace koboshi::cli {

// Gives every option of the program and its commands a placeholder that says what its value is (FILE, FOLDER,
// SECONDS, N, ...) in place of the C++ type that CLI11 shows, and ranges without their type: "N:1 to 64".
// Options that name a type_name() of their own keep it. Positionals show their name alone.
void name_placeholders(CLI::App& program);

// One line about the first argument that stands where a command is expected and is none; nothing where the
// commands are right.
std::optional<std::string> unknown_command(CLI::App& program, int argc, const char* const* argv);

}  // namespace koboshi::cli
