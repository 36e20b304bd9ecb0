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
#include "tools/cli/bench_command.h"
#include "tools/cli/board_command.h"
#include "tools/cli/can_command.h"
#include "tools/cli/dictionary_command.h"
#include "tools/cli/diff_command.h"
#include "tools/cli/experiment_command.h"
#include "tools/cli/firmware_command.h"
#include "tools/cli/gait_command.h"
#include "tools/cli/help.h"
#include "tools/cli/motion_command.h"
#include "tools/cli/run_command.h"
#include "tools/cli/servo_command.h"
#include "tools/cli/target_report_command.h"
#include "tools/cli/tune_command.h"
#include "tools/cli/validate_command.h"
#include "tools/run/interrupt.h"

namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;
constexpr int kSignalled = 128;  // and the signal's number, as shells have it

// As one would type it again; `koboshi` for the path of the program.
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
  int exit_status = 0;
  CLI::App program("The firmware of a small humanoid robot, and the simulated board it runs on.", "koboshi");
  program.set_version_flag("--version", "koboshi " KOBOSHI_VERSION);
  program.require_subcommand(1);
  program.footer(
      "Begin with\n"
      "  koboshi run scenarios/walk.yaml\n"
      "and look into runs/walk. Each command has a --help of its own; docs/guide/ shows what to do with "
      "them.\n\n"
      "Exit status: 0 done; 1 a run or a check failed, or runs differ; 2 bad input, or a file cannot be "
      "written "
      "(one\n"
      "line on standard error says which); 130 interrupted by Ctrl-C, 143 by SIGTERM.\n");
  koboshi::tools::add_run_command(program, exit_status);
  koboshi::tools::add_board_command(program);
  koboshi::tools::add_can_command(program);
  koboshi::tools::add_firmware_command(program);
  koboshi::tools::add_diff_command(program, exit_status);
  koboshi::tools::add_target_report_command(program);
  koboshi::tools::add_motion_command(program);
  koboshi::tools::add_gait_command(program);
  koboshi::tools::add_tune_command(program);
  koboshi::tools::add_dictionary_command(program);
  koboshi::tools::add_bench_command(program);
  koboshi::tools::add_servo_command(program);
  koboshi::tools::add_experiment_command(program, command_line(argc, argv));
  koboshi::tools::add_validate_command(program, exit_status, command_line(argc, argv));
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
  return exit_status;
}

// What was printed may be in a buffer only, and the disk behind it full.
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
