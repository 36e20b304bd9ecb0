#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/help.h"
#include "simulation/scenario/paths.h"
#include "tools/manual/completion.h"
#include "tools/manual/page.h"
#include "tools/manual/studio_options.h"

namespace koboshi::cli {
namespace {

struct ManualArguments {
  std::vector<std::string> words;
  std::string kind;
  std::filesystem::path folder = "manual";
};

// The studio is a program of its own, whose options `koboshi studio` passes on.
struct StudioProgram {
  StudioProgram() : app(tools::kStudioDescription, "koboshi-studio") {
    tools::add_studio_options(app, arguments);
    name_placeholders(app);
  }
  StudioProgram(const StudioProgram&) = delete;
  StudioProgram& operator=(const StudioProgram&) = delete;

  tools::StudioArguments arguments;
  CLI::App app;
};

// The date of the sources (reproducible-builds.org), so that the same sources give the same pages.
tools::PageContext page_context() {
  tools::PageContext context{.version = KOBOSHI_VERSION, .date = {}};
  const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
  if (epoch == nullptr) return context;
  const auto seconds = parse_integer(epoch);
  if (!seconds || *seconds < 0 || *seconds > 253'402'300'799)  // the year 9999
    throw InputError("SOURCE_DATE_EPOCH", 0, one_line(epoch), "seconds since 1970");
  context.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(static_cast<std::time_t>(*seconds)));
  return context;
}

std::vector<tools::Command> documented_commands(const CLI::App& program, const CLI::App& studio) {
  std::vector<tools::Command> commands = tools::all_commands(program, {"koboshi"});
  commands.push_back({&studio, {"koboshi-studio"}});
  return commands;
}

void print_page(const CLI::App& program, const ManualArguments& arguments) {
  std::vector<std::string> words{"koboshi"};
  words.insert(words.end(), arguments.words.begin(), arguments.words.end());
  const std::vector<tools::Command> commands = tools::all_commands(program, {"koboshi"});
  const auto command = std::ranges::find(commands, words, &tools::Command::words);
  if (command == commands.end()) {
    const std::string name = fmt::format("{}", fmt::join(arguments.words, " "));
    throw InputError("COMMAND", 0, one_line(name), "a command of koboshi, such as run or can dump");
  }
  fmt::print("{}", tools::manual_page(*command, page_context()));
}

void write_manual(const CLI::App& program, const std::filesystem::path& folder) {
  const StudioProgram studio;
  const auto pages = folder / "man/man1";
  const auto completions = folder / "bash-completion/completions";
  std::filesystem::create_directories(pages);
  std::filesystem::create_directories(completions);
  const tools::PageContext context = page_context();
  for (const tools::Command& command : documented_commands(program, studio.app)) {
    if (command.joined(" ") == "koboshi studio") continue;  // koboshi-studio.1 is the program's own
    write_whole_file(pages / (command.joined("-") + ".1"), tools::manual_page(command, context));
  }
  write_whole_file(completions / "koboshi", tools::bash_completion(program));
  fmt::print("manual pages and completion in {}\n", folder.string());
}

void print_names(const std::string& kind) {
  const auto print = [](const std::vector<std::string>& names) {
    for (const std::string& name : names) fmt::print("{}\n", name);
  };
  if (kind == "motion")
    return print(simulation::robot_motion_names(
        simulation::find_input(simulation::InputKind::kRobot, "robots/koboshi/robot.sdf")));
  if (kind == "robot") return print(simulation::input_names(simulation::InputKind::kRobot));
  print(simulation::input_names(kind == "study" ? simulation::InputKind::kStudy
                                                : simulation::InputKind::kScenario));
}

}  // namespace

void add_manual_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<ManualArguments>();
  CLI::App* manual =
      program.add_subcommand("manual", "Print manual pages, the completion for bash, and names of inputs");
  manual->require_subcommand(1);
  manual->footer(R"(All of them are generated from the table of commands that --help shows.

Examples:
  koboshi manual page can dump
  koboshi manual completion
  koboshi manual names scenario
  koboshi manual write --folder manual
)");
  CLI::App* page =
      manual->add_subcommand("page", "Print the manual page of koboshi or of a command, for man -l");
  page->add_option("COMMAND", arguments->words, "The command: can dump (default: koboshi itself)");
  page->callback([arguments, &program] { print_page(program, *arguments); });
  CLI::App* completion = manual->add_subcommand("completion", "Print the completion for bash");
  completion->callback([&program] { fmt::print("{}", tools::bash_completion(program)); });
  CLI::App* names = manual->add_subcommand("names", "Print the names that stand for files: koboshi run walk");
  names->add_option("KIND", arguments->kind, "scenario, robot, motion (of the robot Koboshi) or study")
      ->required()
      ->check(CLI::IsMember({"scenario", "robot", "motion", "study"}));
  names->callback([arguments] { print_names(arguments->kind); });
  CLI::App* write = manual->add_subcommand("write", "Write all pages and the completion");
  write
      ->add_option("--folder", arguments->folder, "Folder of the files, with man/ and bash-completion/ in it")
      ->capture_default_str();
  write->callback([arguments, &program] { write_manual(program, arguments->folder); });
}

}  // namespace koboshi::cli
