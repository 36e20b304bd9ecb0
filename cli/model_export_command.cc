#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "base/file/overwrite.h"
#include "cli/commands.h"
#include "simulation/scenario/paths.h"
#include "tools/robot_file/urdf/export_urdf.h"

namespace koboshi::cli {
namespace {

struct ModelExportArguments {
  std::filesystem::path robot;
  std::filesystem::path urdf;
  std::string package;
};

void export_model(const ModelExportArguments& arguments) {
  const std::filesystem::path robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  refuse_to_overwrite({robot}, arguments.urdf);
  for (const std::filesystem::path& file : tools::export_urdf(robot, arguments.urdf, arguments.package))
    fmt::print("{}\n", file.string());
}

}  // namespace

void add_model_export_command(CLI::App& model, Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ModelExportArguments>();
  CLI::App* command = model.add_subcommand("export", "Export a robot as a URDF file for other programs");
  command->footer(
      R"(Writes links with masses, inertias, boxes and meshes, and joints with limits; the meshes are copied beside
the URDF. Servos, sensors, drives and roles, which URDF does not have, follow as a copy of the robot's file in one
element, <koboshi>, that other programs skip. koboshi model import reads it, and gives the same robot
(docs/reference/model-export.md).

Example:
  koboshi model export koboshi --urdf runs/urdf/koboshi.urdf
)");
  command->add_option("ROBOT", arguments->robot, "The robot's file or name")->required();
  command->add_option("--urdf", arguments->urdf, "URDF file to write")->required()->type_name("FILE");
  command
      ->add_option("--package", arguments->package,
                   "ROS package of the URDF's folder: meshes get package:// paths\n(default: relative paths)")
      ->type_name("NAME");
  command->callback([arguments] { export_model(*arguments); });
}

}  // namespace koboshi::cli
