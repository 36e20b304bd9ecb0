#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace koboshi::tools {

// Views of the table of commands and options from which CLI11 also makes `--help`.

// A program or one of its commands.
struct Command {
  const CLI::App* app = nullptr;
  std::vector<std::string> words{};  // koboshi, can, dump

  // "koboshi can dump", "koboshi-can-dump"
  std::string joined(const std::string& separator) const;
};

// Returns the program and all its commands, each before those below it, in the order of `--help`.
[[nodiscard]] std::vector<Command> all_commands(const CLI::App& program, std::vector<std::string> words);

// The commands directly below this one.
[[nodiscard]] std::vector<const CLI::App*> subcommands(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> positionals(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> options(const CLI::App& app);

// Returns the names as one types them: -o, --out.
[[nodiscard]] std::vector<std::string> option_names(const CLI::Option& option);
// Returns the placeholder of the value, such as FILE; empty for a flag.
[[nodiscard]] std::string placeholder(const CLI::Option& option);
// Returns the words that the option accepts; empty if it accepts others, too.
[[nodiscard]] std::vector<std::string> choices(const CLI::Option& option);

}  // namespace koboshi::tools
