#include "tools/cli/commands.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string_view>

#include "sim_board/record/output_file.h"
#include "sim_board/robot/load.h"
#include "sim_board/scenario/paths.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion/compile.h"

namespace koboshi::tools {
namespace {

struct MotionArguments {
  std::filesystem::path motion;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path out;
};

void compile(const MotionArguments& arguments) {
  const simulation::NamedModel model = simulation::load_named_model(sim::load_robot(arguments.robot));
  const std::vector<std::byte> image = simulation::compile_motion(arguments.motion, model);
  std::filesystem::path out = arguments.out;
  if (out.empty()) out = arguments.motion.stem().string() + ".kmot";
  sim::write_whole_file(out, {reinterpret_cast<const char*>(image.data()), image.size()});
  fmt::print("{}: {} bytes for robot model {:08x}\n", out.string(), image.size(), model.model.id);
}

}  // namespace

void add_motion_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<MotionArguments>();
  CLI::App* command = program.add_subcommand("motion", "Check and compile motions");
  command->require_subcommand(1);
  add_motion_check_command(*command, invocation);
  CLI::App* compile_command =
      command->add_subcommand("compile", "Compile a motion file into the image that the firmware plays");
  compile_command->footer(R"(Example:
  koboshi motion compile robots/koboshi/motions/squat.yaml -o squat.kmot
)");
  compile_command->add_option("MOTION", arguments->motion, "A motion file, docs/reference/motion-format.md")
      ->required();
  compile_command->add_option("--robot", arguments->robot, "The robot's file")->capture_default_str();
  compile_command
      ->add_option("-o,--out", arguments->out, "The image (default: the motion's name with .kmot, here)")
      ->type_name("FILE");
  compile_command->callback([arguments] { compile(*arguments); });
}

}  // namespace koboshi::tools
