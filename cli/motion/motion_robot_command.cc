// koboshi motion upload, download and play: the motions of a robot on the bus, and a motion in the
// simulation.

#include "cli/motion/motion_robot_command.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "base/file/output_file.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "bus/can/frame_text.h"
#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "cli/options.h"
#include "cli/run_and_report.h"
#include "firmware/motion/motion.h"
#include "firmware/storage/item.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_check/check.h"
#include "tools/motion_remote/robot_motions.h"
#include "tools/motion_stage/stage.h"

namespace koboshi::cli {
namespace {

struct RobotMotionArguments {
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path motion;
  std::string which;
  std::string number;
  std::filesystem::path out;
  CanOptions can;
  RunArguments run;
};
using Arguments = std::shared_ptr<RobotMotionArguments>;

// Returns the image in a file: compiled from a source, or as it is in a .kmot file.
std::vector<std::byte> image_of(const RobotMotionArguments& arguments, const simulation::NamedModel& robot) {
  if (extension_of(arguments.motion) != ".kmot") return simulation::compile_motion(arguments.motion, robot);
  const std::string bytes = read_text_file(arguments.motion, "the image of a motion");
  const auto data = std::as_bytes(std::span(bytes));
  return {data.begin(), data.end()};
}

void find_inputs(RobotMotionArguments& arguments) {
  arguments.robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  arguments.motion = find_motion_file(arguments.motion, arguments.robot);
}

void upload(RobotMotionArguments& arguments) {
  find_inputs(arguments);
  const simulation::NamedModel robot = simulation::load_named_model(sim_board::load_robot(arguments.robot));
  const std::vector<std::byte> image = image_of(arguments, robot);
  motion::Motion motion;
  if (const auto verdict = motion::Motion::open(image, robot.model, motion); !verdict.ok())
    throw InputError(arguments.motion, 0, simulation::describe(verdict.status), "a motion for this robot");
  const auto transport = open_can(arguments.can);
  tools::RobotMotions motions(*transport);
  const auto number = arguments.number.empty()
                          ? motions.number_for(motion.name())
                          : static_cast<std::uint16_t>(
                                bus::parse_number(arguments.number, "the number", storage::kMaxMotions - 1));
  motions.upload(number, {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()});
  fmt::print("{}: motion {}, {} bytes, read back the same\n", motion.name(), number, image.size());
}

void download(const RobotMotionArguments& arguments) {
  const auto transport = open_can(arguments.can);
  tools::RobotMotions motions(*transport);
  const std::vector<std::uint8_t> image = motions.download(motions.find(arguments.which));
  const auto out = arguments.out.empty() ? std::filesystem::path(arguments.which + ".kmot") : arguments.out;
  write_whole_file(out, {reinterpret_cast<const char*>(image.data()), image.size()});
  fmt::print("{}: {} bytes\n", out.string(), image.size());
}

// Plays a motion file in scenarios/motion.yaml, once the robot stands there. The scenario that is played is
// the file with this motion, so that its record is complete.
int play_in_simulation(RobotMotionArguments& arguments) {
  find_inputs(arguments);
  const tools::MotionReport checked = tools::MotionChecker(arguments.robot).check(arguments.motion);
  RunArguments run = arguments.run;
  run.robot = arguments.robot.string();
  if (run.out.empty()) run.out = std::filesystem::path("runs") / arguments.motion.stem();
  return run_and_report(run, tools::stage_scenario(arguments.motion, checked, scenario_overrides(run)));
}

// A file is played in the simulation; what is no file is a number or a name on the robot. A misspelt file is
// not looked for on the bus.
int play(RobotMotionArguments& arguments) {
  std::error_code ignored;
  const std::filesystem::path which = arguments.which;
  if (std::filesystem::exists(which, ignored) || extension_of(which) == ".yaml" || which.has_parent_path()) {
    arguments.motion = arguments.which;
    return play_in_simulation(arguments);
  }
  const auto transport = open_can(arguments.can);
  tools::RobotMotions motions(*transport);
  motions.play(motions.find(arguments.which));
  return 0;
}

CLI::App* add(CLI::App& motion, const char* name, const char* text, const Arguments& arguments) {
  CLI::App* command = motion.add_subcommand(name, text);
  add_can_options(*command, arguments->can);
  return command;
}

}  // namespace

int list_on_robot(const CanOptions& can) {
  const auto transport = open_can(can);
  for (const tools::RobotMotion& motion : tools::RobotMotions(*transport).list())
    fmt::print("{:3}  {:<24}  {:08x}\n", motion.number, motion.name, motion.crc32);
  return 0;
}

void add_motion_robot_commands(CLI::App& motion, Invocation& invocation) {
  const auto arguments = std::make_shared<RobotMotionArguments>();

  CLI::App* upload_command =
      add(motion, "upload", "Store a motion in the robot on the bus, and read it back", arguments);
  upload_command->add_option("MOTION", arguments->motion, "A motion's file or name, or an image (.kmot)")
      ->required();
  upload_command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  upload_command
      ->add_option("--number", arguments->number,
                   "The number of the motion, 0 to 199 (default: that of the robot's motion with the "
                   "same name, else the lowest free one)")
      ->type_name("NUMBER");
  upload_command->callback([arguments] { upload(*arguments); });

  CLI::App* download_command =
      add(motion, "download", "Read a motion from the robot on the bus into an image", arguments);
  download_command->add_option("MOTION", arguments->which, "Its number or name")->required();
  download_command
      ->add_option("-o,--out", arguments->out, "The image (default: the motion's name with .kmot, here)")
      ->type_name("FILE");
  download_command->callback([arguments] { download(*arguments); });

  CLI::App* play_command = add(
      motion, "play", "Play a motion file in the simulation, or a motion of the robot on the bus", arguments);
  play_command->footer(
      R"(A file is played in scenarios/motion.yaml, where the robot stands before; the results are those of
koboshi run. A number or a name is played by the robot on the bus; the command returns when it has ended, with exit
status 1 if the robot refuses it or is interrupted. The other options are for the simulation.

Examples:
  koboshi motion play robots/koboshi/motions/squat.yaml
  koboshi motion play robots/koboshi/motions/squat.yaml --view
  koboshi motion play squat --can socketcan:vcan0
)");
  play_command->add_option("MOTION", arguments->which, "A motion file; or a number or name on the robot")
      ->required();
  play_command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  add_run_options(*play_command, arguments->run);
  play_command->callback([arguments, &invocation] { invocation.exit_status = play(*arguments); });
}

}  // namespace koboshi::cli
