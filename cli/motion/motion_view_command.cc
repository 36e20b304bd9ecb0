#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "base/text/foreign_text.h"
#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_check/check.h"
#include "tools/motion_view/plot.h"
#include "tools/motion_view/preview.h"
#include "view/film/film.h"

namespace koboshi::cli {
namespace {

struct MotionViewArguments {
  std::filesystem::path motion;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path out;
  view::FilmOptions film;
};

void add_common_options(CLI::App& command, MotionViewArguments& arguments) {
  command
      .add_option("MOTION", arguments.motion, "A motion's file or name, docs/reference/motion-language.md")
      ->required();
  command.add_option("--robot", arguments.robot, "The robot's file or name")->capture_default_str();
  command.add_option("-o,--out", arguments.out, "The file to write")->required()->type_name("FILE");
}

void find_inputs(MotionViewArguments& arguments) {
  arguments.robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  arguments.motion = find_motion_file(arguments.motion, arguments.robot);
}

void plot(MotionViewArguments& arguments) {
  find_inputs(arguments);
  tools::MotionChecker checker(arguments.robot);
  tools::plot_motion(checker.check(arguments.motion), checker, arguments.out);
  fmt::print("{}\n", arguments.out.string());
}

void preview(MotionViewArguments& arguments) {
  find_inputs(arguments);
  tools::MotionChecker checker(arguments.robot);
  const tools::MotionReport report = checker.check(arguments.motion);
  view::FilmOptions& film = arguments.film;
  film.out = arguments.out;
  if (extension_of(film.out) == ".png" && film.at_s.empty() && film.instants == 0)
    film.at_s = {report.least_margin_s};
  for (const view::Overlay overlay : {view::Overlay::kTime, view::Overlay::kEvents, view::Overlay::kZmp,
                                      view::Overlay::kCom, view::Overlay::kSupport, view::Overlay::kLegend})
    film.overlays.add(overlay);
  film.translucent = true;
  view::render(tools::preview_recording(report, checker), film, [](int, int) {});
  fmt::print("{}\n", arguments.out.string());
}

}  // namespace

void add_motion_plot_command(CLI::App& motion_command, Invocation&) {
  auto arguments = std::make_shared<MotionViewArguments>();
  CLI::App* command = motion_command.add_subcommand("plot", "Draw angles, speeds and margins of a motion");
  command->footer(
      R"(Shows what koboshi motion check computes, with its findings as marks. The extension of --out is
.png or .svg.

Example:
  koboshi motion plot robots/koboshi/motions/squat.yaml -o squat.png
)");
  add_common_options(*command, *arguments);
  command->callback([arguments] { plot(*arguments); });
}

void add_motion_preview_command(CLI::App& motion_command, Invocation&) {
  auto arguments = std::make_shared<MotionViewArguments>();
  CLI::App* command =
      motion_command.add_subcommand("preview", "Draw a picture or film of a motion, without physics");
  command->footer(
      R"(Shows the robot on its soles with ZMP, centre of mass and support polygon. The extension of --out
selects the kind, as for koboshi render; a .png without --at or --frames shows the least margin.

Examples:
  koboshi motion preview robots/koboshi/motions/squat.yaml -o squat.mp4
  koboshi motion preview robots/koboshi/motions/squat.yaml -o squat.png --frames 6
)");
  add_common_options(*command, *arguments);
  view::FilmOptions& film = arguments->film;
  CLI::Option* at = command->add_option("--at", film.at_s, "Time of a picture; several give a strip: 1,2.5,4")
                        ->delimiter(',')
                        ->allow_extra_args(false)
                        ->type_name("SECONDS");
  command->add_option("--frames", film.instants, "A strip of this many instants")
      ->check(CLI::Range(1, 64))
      ->excludes(at);
  command->add_option("--speed", film.speed, "Seconds of the motion per second of film")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->callback([arguments] { preview(*arguments); });
}

}  // namespace koboshi::cli
