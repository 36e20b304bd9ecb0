#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_files/export.h"

namespace koboshi::cli {
namespace {

struct MotionExportArguments {
  std::filesystem::path motion;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path map;
  std::filesystem::path out;
  std::string format;
};

void export_file(const MotionExportArguments& arguments) {
  const auto robot_file = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  const auto file = find_motion_file(arguments.motion, robot_file);
  const sim_board::RobotDescription robot = sim_board::load_robot(robot_file);
  const simulation::NamedModel model = simulation::load_named_model(robot);
  const simulation::MotionSource source = simulation::parse_motion(file, model);
  static_cast<void>(
      simulation::compile_motion(source, model));  // a motion that the robot refuses is not exported
  const tools::ExportedMotion exported =
      tools::export_motion(source, *tools::writable_format(arguments.format), robot, model, arguments.map);
  refuse_to_overwrite({file, robot_file, arguments.map}, arguments.out);
  write_whole_file(arguments.out, exported.bytes);
  for (const std::string& line : exported.report) print_error("{}: {}\n", file.string(), utf8_line(line));
  print_error("{}: {}, {:.3f} s\n", file.string(), count_text(exported.frames, "key frame"),
              exported.duration_s);
}

}  // namespace

void add_motion_export_command(CLI::App& motion_command, Invocation& /*invocation*/) {
  auto arguments = std::make_shared<MotionExportArguments>();
  CLI::App* command =
      motion_command.add_subcommand("export", "Write a motion in the format of another maker");
  command->footer(
      R"(Writes key frames for Webots, ROBOTIS (mtn, bin), the Bit-Bots or Choreonoid, or a table. Loops are repeated. What the
format cannot say is named on the standard error output (docs/reference/motion-import.md).

Examples:
  koboshi motion export wave --format webots -o wave.motion
  koboshi motion export wave --format csv -o wave.csv
)");
  command->add_option("MOTION", arguments->motion, "A motion's file or name")->required();
  command->add_option("--format", arguments->format, "The format of the file")
      ->required()
      ->check(CLI::IsMember(tools::writable_formats()))
      ->type_name("NAME");
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  command->add_option("--map", arguments->map, "Names and numbers of the robot's joints in the file")
      ->type_name("FILE");
  command->add_option("-o,--out", arguments->out, "The file to write")->required()->type_name("FILE");
  command->callback([arguments] { export_file(*arguments); });
}

}  // namespace koboshi::cli
