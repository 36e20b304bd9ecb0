#include "tools/cli/dictionary_command.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "sim_board/record/output_file.h"
#include "sim_board/robot/load.h"
#include "sim_board/scenario/reader.h"
#include "tools/dictionary/files.h"
#include "simulation/scenario/parameters.h"

namespace koboshi::tools {
namespace {

struct DictionaryArguments {
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path folder = "docs/reference";
  std::string kind;
};

std::vector<GeneratedFile> files(const DictionaryArguments& arguments) {
  return dictionary_files(sim::load_robot(arguments.robot),
                          simulation::controller_values(sim::read_robot_parameters(arguments.robot)));
}

void print_file(const DictionaryArguments& arguments, const std::string& name) {
  for (const GeneratedFile& file : files(arguments)) {
    if (file.name == name) fmt::print("{}", file.text);
  }
}

void write_files(const DictionaryArguments& arguments) {
  for (const GeneratedFile& file : files(arguments)) {
    sim::write_whole_file(arguments.folder / file.name, file.text);
    fmt::print("{}\n", (arguments.folder / file.name).string());
  }
}

}  // namespace

void add_dictionary_command(CLI::App& program) {
  auto arguments = std::make_shared<DictionaryArguments>();
  CLI::App* command = program.add_subcommand("dictionary", "The nodes' objects as EDS, DBC and page");
  command->require_subcommand(1);
  command->footer(
      "All of it comes from the tables that the nodes themselves are made of. After a change of one:\n"
      "  koboshi dictionary write\n"
      "A test fails while docs/reference/ says anything else.\n");
  command->add_option("--robot", arguments->robot, "The robot's file: names of nodes, worth of counts")
      ->capture_default_str();

  CLI::App* eds =
      command->add_subcommand("eds", "Print the electronic data sheet of a kind of node (CiA 306)");
  eds->add_option("KIND", arguments->kind, "controller, drive, inertial or ankle")
      ->required()
      ->check(CLI::IsMember({"controller", "drive", "inertial", "ankle"}));
  eds->callback([arguments] { print_file(*arguments, arguments->kind + ".eds"); });
  CLI::App* dbc = command->add_subcommand("dbc", "Print the messages on the robot's bus for CAN tools");
  dbc->callback([arguments] { print_file(*arguments, "koboshi.dbc"); });
  CLI::App* bus = command->add_subcommand(
      "bus", "Print drives and sensors for dcfgen of lely-core, which makes a master of it");
  bus->callback([arguments] { print_file(*arguments, "bus.yml"); });
  CLI::App* page = command->add_subcommand("page", "Print the reference page");
  page->callback([arguments] { print_file(*arguments, "object-dictionary.md"); });
  CLI::App* parameters =
      command->add_subcommand("parameters", "Print the page of the controller's parameters");
  parameters->callback([arguments] { print_file(*arguments, "parameters.md"); });
  CLI::App* write = command->add_subcommand("write", "Write all of them");
  write->add_option("--folder", arguments->folder, "Where to")->capture_default_str();
  write->callback([arguments] { write_files(*arguments); });
}

}  // namespace koboshi::tools
