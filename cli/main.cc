#include <CLI/CLI.hpp>
#include <cstddef>
#include <iostream>
#include <sstream>
#include <string>

#include "base/file/standard_streams.h"
#include "base/text/shell_word.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/help.h"
#include "tools/run/exit_status.h"

namespace {

constexpr const char* kFooter = R"(Begin with
  koboshi run scenarios/walk.yaml
and look into runs/walk. Each command has a --help of its own; docs/guide/ shows how to use them.

Exit status: 0 done; 1 a run or a check failed, or runs differ; 2 bad input, or a file cannot be written
(one line on standard error names it); 130 interrupted by Ctrl-C, 143 by SIGTERM. Either signal is the normal
end, with status 0, of a command that lasts until the user ends it: run in real time, board, firmware, and can
dump and can stats of a live bus or a pipe.
)";

// The command line as one would type it again, with `koboshi` for the path of the program.
std::string command_line(int argc, char** argv) {
  std::string line = "koboshi";
  for (int i = 1; i < argc; ++i) line += " " + koboshi::shell_word(argv[i]);
  return line;
}

int run_program(int argc, char** argv) {
  koboshi::cli::Invocation invocation{command_line(argc, argv), {argv + 1, argv + argc}};
  CLI::App program("The firmware of a small humanoid robot, and the simulated board it runs on.", "koboshi");
  program.set_version_flag("--version", "koboshi " KOBOSHI_VERSION);
  program.require_subcommand(1);
  program.footer(kFooter);
  for (koboshi::cli::AddCommand* add_command : koboshi::cli::kCommands) add_command(program, invocation);
  koboshi::cli::name_placeholders(program);
  if (const auto message = koboshi::cli::unknown_command(program, argc, argv)) {
    koboshi::print_error("{}\n", *message);
    return koboshi::tools::kBadInput;
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream message;  // quotes arguments
    const int status = program.exit(error, std::cout, message);
    koboshi::write_to_standard_error(koboshi::utf8_text(message.str()));
    return status == 0 ? 0 : koboshi::tools::kBadInput;
  }
  return invocation.exit_status;
}

}  // namespace

int main(int argc, char** argv) {
  return koboshi::tools::exit_status_of("koboshi", {argv, static_cast<std::size_t>(argc)},
                                        [&] { return run_program(argc, argv); });
}
