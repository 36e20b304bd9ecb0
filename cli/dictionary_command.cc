#include "cli/commands.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "bus/dictionary/files.h"
#include "sim_board/description/load.h"
#include "simulation/assembly/parameters.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"

namespace koboshi::cli {
namespace {

struct DictionaryArguments {
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path folder = "docs/reference";
  std::string kind;
};

std::vector<bus::GeneratedFile> files(const DictionaryArguments& arguments) {
  const auto robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  return bus::dictionary_files(sim_board::load_robot(robot),
                               simulation::controller_values(simulation::read_robot_parameters(robot)));
}

void print_file(const DictionaryArguments& arguments, const std::string& name) {
  for (const bus::GeneratedFile& file : files(arguments)) {
    if (file.name == name) fmt::print("{}", file.text);
  }
}

void write_files(const DictionaryArguments& arguments) {
  for (const bus::GeneratedFile& file : files(arguments)) {
    write_whole_file(arguments.folder / file.name, file.text);
    fmt::print("{}\n", (arguments.folder / file.name).string());
  }
}

}  // namespace

void add_dictionary_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<DictionaryArguments>();
  CLI::App* command =
      program.add_subcommand("dictionary", "Write the nodes' object dictionaries as EDS, DBC and page");
  command->require_subcommand(1);
  command->footer(
      R"(All formats are generated from the tables that the nodes themselves use. After a change of a table:
  koboshi dictionary write
A test fails while docs/reference/ is out of date.
)");
  command
      ->add_option("--robot", arguments->robot,
                   "The robot's file or name: names of its nodes, resolutions of its sensors")
      ->capture_default_str();

  CLI::App* eds =
      command->add_subcommand("eds", "Print the electronic data sheet of a kind of node (CiA 306)");
  eds->add_option("KIND", arguments->kind, "controller, drive, inertial, ankle, cells or switch")
      ->required()
      ->check(CLI::IsMember({"controller", "drive", "inertial", "ankle", "cells", "switch"}));
  eds->callback([arguments] { print_file(*arguments, arguments->kind + ".eds"); });
  CLI::App* dbc = command->add_subcommand("dbc", "Print the messages on the robot's bus, for CAN tools");
  dbc->callback([arguments] { print_file(*arguments, "koboshi.dbc"); });
  CLI::App* bus =
      command->add_subcommand("bus", "Print the configuration of a CANopen master, for dcfgen of lely-core");
  bus->callback([arguments] { print_file(*arguments, "bus.yml"); });
  CLI::App* page = command->add_subcommand("page", "Print the reference page");
  page->callback([arguments] { print_file(*arguments, "object-dictionary.md"); });
  CLI::App* parameters =
      command->add_subcommand("parameters", "Print the page of the controller's parameters");
  parameters->callback([arguments] { print_file(*arguments, "parameters.md"); });
  CLI::App* write = command->add_subcommand("write", "Write all of these files");
  write->add_option("--folder", arguments->folder, "Folder of the files")->capture_default_str();
  write->callback([arguments] { write_files(*arguments); });
}

}  // namespace koboshi::cli
