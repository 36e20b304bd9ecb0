#include "cli/commands.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "cli/options.h"
#include "sim_board/description/load.h"
#include "simulation/gait/gait_motion.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/scenario/paths.h"
#include "tools/gait/gait_figure.h"
#include "tools/plot/figure.h"

namespace koboshi::cli {
namespace {

struct GaitArguments {
  std::filesystem::path gait;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::string points;
  std::vector<std::string> sets;
  std::filesystem::path out;
};

void make_gait(const GaitArguments& arguments) {
  const auto overrides = overrides_of(arguments.sets, {{"points", arguments.points, "--points"}});
  const sim_board::RobotDescription robot =
      sim_board::load_robot(simulation::find_input(simulation::InputKind::kRobot, arguments.robot));
  const simulation::NamedModel model = simulation::load_named_model(robot);
  const std::filesystem::path file = simulation::find_input(simulation::InputKind::kGait, arguments.gait);
  const simulation::Gait gait = simulation::read_gait(file, overrides);
  const simulation::MotionSource motion = simulation::make_gait_motion(gait, robot, model);
  static_cast<void>(simulation::compile_motion(motion, model));  // throws where the firmware would refuse it

  const std::filesystem::path prefix = arguments.out.empty() ? std::filesystem::path("walk") : arguments.out;
  refuse_to_overwrite({file}, prefix.string() + ".yaml");
  write_whole_file(prefix.string() + ".yaml", simulation::gait_motion_text(motion, model));
  tools::draw_gait(gait, robot, model, prefix);
  const simulation::GaitPlan plan(gait);
  fmt::print(
      "{0}.yaml: {1} poses, {2:.2f} s to start, {3:.3f} s and {4:.0f} mm per cycle, {5:.3f} m/s planned\n"
      "{0}.png, {0}.svg: the profile and its approximation by {6} points; {0}.csv: their numbers\n",
      prefix.string(), motion.poses.size(), plan.start_s(), plan.cycle_s(), 1000.0 * plan.stride_m(),
      plan.stride_m() / plan.cycle_s(), gait.points);
}

}  // namespace

void add_gait_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<GaitArguments>();
  CLI::App* command =
      program.add_subcommand("gait", "Generate a walking motion with the linear inverted pendulum");
  command->footer(
      R"(Divides the walk of a gait file into points, computes the pose of each by inverse kinematics, and writes
the motion, its profile and a figure like the paper's figure 6. A scenario with the key `gait` generates its
motion itself.

Examples:
  koboshi gait robots/koboshi/gait.yaml
  koboshi gait robots/koboshi/gait.yaml --points 4 --set step_length_m=0.03 --out walk_4
)");
  command
      ->add_option("GAIT", arguments->gait,
                   "A gait file, or the name of a robot for its gait, docs/reference/gait-format.md")
      ->required();
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  command->add_option("--points", arguments->points,
                      "Points per cycle of two steps (default: the gait file's)");
  command->add_option("--set", arguments->sets, "Override a key of the gait: period_s=0.6; may be repeated")
      ->allow_extra_args(false);
  command->add_option("-o,--out", arguments->out, "Path of the files, without extension (default: walk)")
      ->type_name("PREFIX");
  command->callback([arguments] { make_gait(*arguments); });
}

}  // namespace koboshi::cli
