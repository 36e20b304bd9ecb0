#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "base/file/standard_streams.h"
#include "cli/commands.h"

namespace koboshi::cli {
namespace {

constexpr int kMissing = 2;

// The studio is a program of its own beside this one, so that this one needs no Qt.
int start_studio(std::vector<std::string> arguments) {
  const std::filesystem::path studio =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "koboshi-studio";
  if (!std::filesystem::exists(studio)) {
    print_error(
        "koboshi studio: there is no koboshi-studio beside this program: install the package koboshi-studio, "
        "or build it with `./run studio`; `koboshi replay RUN --html` writes replay.html for a browser\n");
    return kMissing;
  }
  arguments.insert(arguments.begin(), studio.string());
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(studio.c_str(), argv.data());
  throw std::system_error(errno, std::generic_category(), studio.string());
}

}  // namespace

void add_studio_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("studio", "Open the window: run, watch and push the robot, edit motions");
  command->prefix_command();
  command->set_help_flag();  // the studio's own --help
  command->footer(R"(Examples:
  koboshi studio scenarios/walk.yaml
  koboshi studio robots/koboshi/motions/squat.yaml
  koboshi studio runs/walk
)");
  command->callback([command, &invocation] { invocation.exit_status = start_studio(command->remaining()); });
}

}  // namespace koboshi::cli
