#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/file/standard_streams.h"
#include "cli/commands.h"
#include "sim_board/description/load.h"
#include "simulation/scenario/paths.h"
#include "tools/robot_file/map/joint_pictures.h"
#include "tools/robot_file/map/role_map.h"

namespace koboshi::cli {
namespace {

struct ModelMapArguments {
  std::filesystem::path robot;
  std::vector<std::string> corrections;
  std::filesystem::path pictures;
  bool write = false;
};

void map_model(const ModelMapArguments& arguments) {
  const std::filesystem::path file = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  const sim_board::RobotDescription robot = sim_board::load_robot(file);
  tools::RoleMap map = tools::propose_roles(robot);
  for (const std::string& correction : arguments.corrections) tools::correct_role(robot, correction, map);
  fmt::print("{}", tools::role_map_text(robot, map));
  if (arguments.write) {
    XmlDocument document(file);
    const std::string before = document.text();
    sim_board::apply_settings(document, tools::role_settings(robot, map), sim_board::Sides::kOne);
    if (document.text() != before) document.save();
  }
  if (arguments.pictures.empty()) return;
  for (const std::filesystem::path& picture : tools::draw_joint_pictures(robot, arguments.pictures))
    write_to_standard_error(picture.string() + "\n");
}

}  // namespace

void add_model_map_command(CLI::App& model, Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ModelMapArguments>();
  CLI::App* map = model.add_subcommand("map", "Propose the roles of a robot's joints, such as left_knee");
  map->footer(
      R"(Firmware, gaits and motions refer to joints by their roles. A joint without koboshi:role has its name as
role. This command proposes roles from the tree of links, the axes and the masses, whatever the names are, and
prints them as YAML. ROLE=JOINT corrects the proposal; ROLE= leaves a role to no joint
(docs/reference/model-map.md).

Examples:
  koboshi model map robots/koboshi/robot.sdf
  koboshi model map robots/koboshi/robot.sdf --pictures runs/joints
)");
  map->add_option("ROBOT", arguments->robot, "The robot's file or name")->required();
  map->add_option("CORRECTION", arguments->corrections, "Corrections of the proposal, each ROLE=JOINT");
  map->add_option("--pictures", arguments->pictures,
                  "Draw into this folder a picture for each joint, turned by 20 degrees")
      ->type_name("FOLDER");
  map->add_flag("--write", arguments->write, "Write roles and mirrors into the robot's file");
  map->callback([arguments] { map_model(*arguments); });
}

}  // namespace koboshi::cli
