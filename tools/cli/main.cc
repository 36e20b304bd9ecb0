#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <fmt/core.h>

#include "sim_board/input/error.h"
#include "sim_board/record/output_file.h"
#include "simulation/motion/diagnostic.h"
#include "tools/cli/commands.h"
#include "tools/cli/help.h"
#include "tools/run/interrupt.h"

namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;
constexpr int kSignalled = 128;  // plus the signal's number, as in shells

constexpr const char* kFooter = R"(Begin with
  koboshi run scenarios/walk.yaml
and look into runs/walk. Each command has a --help of its own; docs/guide/ shows how to use them.

Exit status: 0 done; 1 a run or a check failed, or runs differ; 2 bad input, or a file cannot be written
(one line on standard error names it); 130 interrupted by Ctrl-C, 143 by SIGTERM.
)";

// The command line as one would type it again, with `koboshi` for the path of the program.
std::string command_line(int argc, char** argv) {
  std::string line = "koboshi";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool plain = argument.find_first_of(" \t\n'\"$&|;<>()[]{}*?#!\\`") == std::string::npos;
    line += plain ? " " + argument : " '" + argument + "'";
  }
  return line;
}

int run_program(int argc, char** argv) {
  koboshi::tools::Invocation invocation{command_line(argc, argv)};
  CLI::App program("The firmware of a small humanoid robot, and the simulated board it runs on.", "koboshi");
  program.set_version_flag("--version", "koboshi " KOBOSHI_VERSION);
  program.require_subcommand(1);
  program.footer(kFooter);
  for (koboshi::tools::AddCommand* add_command : koboshi::tools::kCommands) add_command(program, invocation);
  koboshi::tools::name_placeholders(program);
  if (const auto message = koboshi::tools::unknown_command(program, argc, argv)) {
    fmt::print(stderr, "{}\n", *message);
    return kBadInput;
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kBadInput;
  }
  return invocation.exit_status;
}

// Throws WriteError where printed text cannot be written: it may still be in a buffer, and the disk full.
void close_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw koboshi::sim::WriteError("standard output", errno);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error like a full disk
  try {
    const int exit_status = run_program(argc, argv);
    close_standard_output();
    return exit_status;
  } catch (const koboshi::simulation::MotionError& error) {
    fmt::print(stderr, "{}", koboshi::simulation::print(error.diagnostics()));
    return kBadInput;
  } catch (const koboshi::sim::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kBadInput;
  } catch (const koboshi::sim::WriteError& error) {
    fmt::print(stderr, "koboshi: {}\n", error.what());
    return kBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "koboshi: {}\n", error.what());
    return kBadInput;
  } catch (const koboshi::tools::Interrupted& interrupted) {
    fmt::print(stderr, "koboshi: {}\n", interrupted.what());
    return kSignalled + interrupted.signal();
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "koboshi: {}\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "koboshi: {}\n", error.what());
    return kFailed;
  }
}
