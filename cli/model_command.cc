#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "cli/commands.h"
#include "simulation/scenario/paths.h"
#include "tools/robot_file/check/model_check.h"
#include "tools/robot_file/reference/reference.h"

namespace koboshi::cli {
namespace {

struct ModelCheckArguments {
  std::vector<std::filesystem::path> robots;
  bool json = false;
};

struct ModelReferenceArguments {
  std::filesystem::path folder = "docs/reference";
};

void print_reference(const std::string& name) {
  for (const tools::RobotReferenceFile& file : tools::robot_reference_files())
    if (file.name == name) fmt::print("{}", file.text);
}

void write_reference(const std::filesystem::path& folder) {
  for (const tools::RobotReferenceFile& file : tools::robot_reference_files()) {
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

// Prints the reports of all robots; a file that cannot be read is a line of standard error, and the others
// are checked nevertheless. Returns the exit status.
int check_models(const ModelCheckArguments& arguments) {
  int status = 0;
  std::vector<std::string> documents;
  const bool is_list = arguments.robots.size() > 1;
  for (const std::filesystem::path& robot : arguments.robots) {
    try {
      const tools::ModelReport report =
          tools::check_model(simulation::find_input(simulation::InputKind::kRobot, robot));
      if (report.has_errors()) status = std::max(status, 1);
      if (arguments.json) {
        documents.push_back(tools::model_report_json(report));
      } else {
        if (is_list) fmt::print("{}{}:\n", documents.empty() ? "" : "\n", report.file.string());
        documents.push_back(tools::model_report_text(report));
        fmt::print("{}", documents.back());
      }
    } catch (const InputError& error) {
      if (!is_list) throw;
      std::fflush(stdout);
      print_error("{}\n", error.what());
      status = 2;
    }
  }
  if (!arguments.json) return status;
  if (!is_list) {
    fmt::print("{}", documents.front());
    return status;
  }
  // A valid document whatever the reports are.
  fmt::print("[\n");
  for (std::size_t i = 0; i < documents.size(); ++i)
    fmt::print("{}{}", std::string_view(documents[i]).substr(0, documents[i].find_last_not_of('\n') + 1),
               i + 1 < documents.size() ? ",\n" : "\n");
  fmt::print("]\n");
  return status;
}

void add_check(CLI::App& model, Invocation& invocation) {
  auto arguments = std::make_shared<ModelCheckArguments>();
  CLI::App* check =
      model.add_subcommand("check", "Check a robot's file: masses, sides, meshes, soles, servos");
  check->footer(
      R"(Prints the tree of links, masses, sizes and the load of a squat, and what a robot should not have, each
finding with its line and a proposed repair (docs/reference/model-check.md). Several robots are checked one after
the other. Exit status 1 if there is an error, 2 if a file cannot be read.

Examples:
  koboshi model check robots/koboshi/robot.sdf
  koboshi model check robots/chibi robots/hanpo robots/noppo
)");
  check->add_option("ROBOT", arguments->robots, "The robot's file or name; may be repeated")->required();
  check->add_flag("--json", arguments->json, "Print a JSON object, or an array of them for several robots");
  check->callback([arguments, &invocation] { invocation.exit_status = check_models(*arguments); });
}

}  // namespace

void add_model_command(CLI::App& program, Invocation& invocation) {
  CLI::App* model = program.add_subcommand(
      "model", "Import, check, change and export the model of a robot; its file's reference");
  model->require_subcommand(1);
  add_check(*model, invocation);
  add_model_edit_commands(*model, invocation);
  add_model_export_command(*model, invocation);
  add_model_import_command(*model, invocation);
  add_model_map_command(*model, invocation);
  add_reference(*model);
}

}  // namespace koboshi::cli
