#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "tools/cli/commands.h"
#include "tools/robot/check/model_check.h"

namespace koboshi::tools {
namespace {

struct ModelCheckArguments {
  std::filesystem::path robot;
  bool json = false;
};

}  // namespace

void add_model_command(CLI::App& program, Invocation& invocation) {
  CLI::App* model = program.add_subcommand("model", "Check the model of a robot");
  model->require_subcommand(1);
  auto arguments = std::make_shared<ModelCheckArguments>();
  CLI::App* check =
      model->add_subcommand("check", "Check a robot's file: masses, sides, meshes, soles, servos");
  check->footer(
      R"(Prints the tree of links, masses, sizes and the load of a squat, and what a robot should not have, each
finding with its line and a proposed repair (docs/reference/model-check.md). Exit status 1 if there is an
error.

Example:
  koboshi model check robots/koboshi/robot.sdf
)");
  check->add_option("ROBOT", arguments->robot, "The robot's file")->required();
  check->add_flag("--json", arguments->json, "Print a JSON object");
  check->callback([arguments, &invocation] {
    const ModelReport report = check_model(arguments->robot);
    fmt::print("{}", arguments->json ? model_report_json(report) : model_report_text(report));
    if (report.has_errors()) invocation.exit_status = 1;
  });
}

}  // namespace koboshi::tools
