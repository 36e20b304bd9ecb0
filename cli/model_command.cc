#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "cli/commands.h"
#include "simulation/scenario/paths.h"
#include "tools/robot_file/check/model_check.h"
#include "tools/robot_file/reference/reference.h"

namespace koboshi::tools {
namespace {

struct ModelCheckArguments {
  std::filesystem::path robot;
  bool json = false;
};

struct ModelReferenceArguments {
  std::filesystem::path folder = "docs/reference";
};

void print_reference(const std::string& name) {
  for (const RobotReferenceFile& file : robot_reference_files())
    if (file.name == name) fmt::print("{}", file.text);
}

void write_reference(const std::filesystem::path& folder) {
  for (const RobotReferenceFile& file : robot_reference_files()) {
    write_whole_file(folder / file.name, file.text);
    fmt::print("{}\n", (folder / file.name).string());
  }
}

void add_reference(CLI::App& model) {
  auto arguments = std::make_shared<ModelReferenceArguments>();
  CLI::App* reference =
      model.add_subcommand("reference", "Print the reference of a robot's file: page and XML Schema");
  reference->require_subcommand(1);
  reference->footer(
      R"(All of them are generated from the table by which the reader checks a robot's file. After a change of the
table:
  koboshi model reference write
A test fails while docs/reference/ is out of date.
)");
  reference->add_subcommand("page", "Print the reference page")->callback([] {
    print_reference("robot-file.md");
  });
  reference->add_subcommand("xsd", "Print the XML Schema of a robot's file")->callback([] {
    print_reference("robot.xsd");
  });
  reference->add_subcommand("koboshi-xsd", "Print the XML Schema of the koboshi: elements")->callback([] {
    print_reference("robot-koboshi.xsd");
  });
  CLI::App* write = reference->add_subcommand("write", "Write all of these files");
  write->add_option("--folder", arguments->folder, "Folder of the files")->capture_default_str();
  write->callback([arguments] { write_reference(arguments->folder); });
}

void add_check(CLI::App& model, Invocation& invocation) {
  auto arguments = std::make_shared<ModelCheckArguments>();
  CLI::App* check =
      model.add_subcommand("check", "Check a robot's file: masses, sides, meshes, soles, servos");
  check->footer(
      R"(Prints the tree of links, masses, sizes and the load of a squat, and what a robot should not have, each
finding with its line and a proposed repair (docs/reference/model-check.md). Exit status 1 if there is an
error.

Example:
  koboshi model check robots/koboshi/robot.sdf
)");
  check->add_option("ROBOT", arguments->robot, "The robot's file or name")->required();
  check->add_flag("--json", arguments->json, "Print a JSON object");
  check->callback([arguments, &invocation] {
    const ModelReport report =
        check_model(simulation::find_input(simulation::InputKind::kRobot, arguments->robot));
    fmt::print("{}", arguments->json ? model_report_json(report) : model_report_text(report));
    if (report.has_errors()) invocation.exit_status = 1;
  });
}

}  // namespace

void add_model_command(CLI::App& program, Invocation& invocation) {
  CLI::App* model =
      program.add_subcommand("model", "Import, check, change and export the model of a robot; its file's reference");
  model->require_subcommand(1);
  add_check(*model, invocation);
  add_model_edit_commands(*model, invocation);
  add_model_export_command(*model, invocation);
  add_model_import_command(*model, invocation);
  add_model_map_command(*model, invocation);
  add_reference(*model);
}

}  // namespace koboshi::tools
