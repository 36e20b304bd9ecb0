#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_check/check.h"
#include "tools/motion_check/text.h"

namespace koboshi::cli {
namespace {

struct MotionCheckArguments {
  std::vector<std::filesystem::path> motions;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  bool steps = false;
  bool json = false;
};

void check_motions(const MotionCheckArguments& arguments, Invocation& invocation) {
  const auto robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  tools::MotionChecker checker(robot);
  for (const std::filesystem::path& motion : arguments.motions) {
    const tools::MotionReport report = checker.check(find_motion_file(motion, robot));
    const std::string text = arguments.json ? tools::report_json(report, checker)
                                            : tools::report_text(report, checker, arguments.steps);
    fmt::print("{}", text);
    if (report.has_errors()) invocation.exit_status = 1;
  }
}

}  // namespace

void add_motion_check_command(CLI::App& motion_command, Invocation& invocation) {
  auto arguments = std::make_shared<MotionCheckArguments>();
  CLI::App* command = motion_command.add_subcommand(
      "check", "Check a motion against the robot: limits, torque, collisions, balance");
  command->footer(
      R"(Plays the motion in the firmware's interpreter, without physics, and reports what the robot
cannot do, step by step (docs/reference/motion-check.md). Exit status 1 if there is an error.

Examples:
  koboshi motion check robots/koboshi/motions/squat.yaml
  koboshi motion check robots/koboshi/motions/wave.yaml --steps
)");
  command
      ->add_option("MOTION", arguments->motions, "Motions' files or names, docs/reference/motion-language.md")
      ->required();
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  CLI::Option* steps = command->add_flag("--steps", arguments->steps, "Also print a line for each step");
  command->add_flag("--json", arguments->json, "Print a JSON object for each motion")->excludes(steps);
  command->callback([arguments, &invocation] { check_motions(*arguments, invocation); });
}

}  // namespace koboshi::cli
