#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "tools/run/interrupt.h"
#include "view/film/film.h"
#include "view/recording/read_recording.h"

namespace koboshi::cli {
namespace {

constexpr int kMinSize_px = 64;
constexpr int kMaxSize_px = 8192;

struct RenderArguments {
  std::filesystem::path run;
  view::FilmOptions options;
  std::string size;
  std::string camera = "follow";
  std::string view;
  std::optional<double> azimuth_deg;
  std::optional<double> elevation_deg;
  double turn_deg_per_s = 30.0;
  std::vector<double> target_m;
  std::vector<std::string> overlays{"time", "events", "zmp", "footprints", "pushes", "legend"};
};

std::vector<std::string> view_names() {
  std::vector<std::string> names;
  for (const view::NamedView& one : view::kNamedViews) names.emplace_back(one.option);
  return names;
}

// The number of pixels, 0 for any other text.
int pixels(std::string_view text) {
  const std::int64_t number = parse_integer(text).value_or(0);
  return number >= kMinSize_px && number <= kMaxSize_px ? static_cast<int>(number) : 0;
}

void set_size(const std::string& text, view::FilmOptions& options) {
  if (text.empty()) return;
  const std::string_view all(text);
  const std::size_t cross = std::min(all.find('x'), all.size());
  options.width_px = pixels(all.substr(0, cross));
  options.height_px = cross < all.size() ? pixels(all.substr(cross + 1)) : 0;
  if (options.width_px == 0 || options.height_px == 0)
    throw InputError(
        "--size", 0, one_line(text),
        fmt::format("WIDTHxHEIGHT in pixels, each {} to {}, such as 1280x720", kMinSize_px, kMaxSize_px));
}

void set_camera(const RenderArguments& arguments, view::CameraChoice& camera) {
  camera.motion = arguments.camera == "fixed"   ? view::CameraMotion::kFixed
                  : arguments.camera == "orbit" ? view::CameraMotion::kOrbit
                                                : view::CameraMotion::kFollow;
  const std::string name = arguments.view.empty() ? "iso" : arguments.view;
  const view::NamedView& named = *std::ranges::find(view::kNamedViews, name, &view::NamedView::option);
  camera.azimuth_rad = kRadPerDegree * arguments.azimuth_deg.value_or(named.azimuth_deg);
  camera.elevation_rad = kRadPerDegree * arguments.elevation_deg.value_or(named.elevation_deg);
  camera.orbit_rad_per_s = kRadPerDegree * arguments.turn_deg_per_s;
  if (!arguments.target_m.empty())
    camera.target_W_m = Eigen::Vector3d(arguments.target_m[0], arguments.target_m[1], arguments.target_m[2]);
}

view::Overlays overlays_of(const std::vector<std::string>& names) {
  view::Overlays overlays;
  for (std::size_t i = 0; i < view::kOverlayNames.size(); ++i) {
    const bool all = std::ranges::find(names, "all") != names.end();
    if (all || std::ranges::find(names, view::kOverlayNames[i]) != names.end())
      overlays.add(static_cast<view::Overlay>(i));
  }
  return overlays;
}

std::vector<std::string> overlay_names() {
  std::vector<std::string> names(view::kOverlayNames.begin(), view::kOverlayNames.end());
  names.insert(names.end(), {"all", "none"});
  return names;
}

void show_progress(int frames, int total, int& shown) {
  if (isatty(STDERR_FILENO) == 0 || std::exchange(shown, frames) == frames) return;
  print_error("\r{} of {} frames{}", frames, total, frames == total ? "\n" : " ");
}

void render_run(RenderArguments& arguments) {
  set_size(arguments.size, arguments.options);
  set_camera(arguments, arguments.options.camera);
  arguments.options.overlays = overlays_of(arguments.overlays);
  refuse_to_overwrite({arguments.run, arguments.run / "run.mcap"}, arguments.options.out);
  const view::Recording recording = view::read_recording(arguments.run);
  warn_of_meshes(recording);
  tools::Interrupt interrupt;
  int shown = 0;
  view::render(recording, arguments.options, [&](int frames, int total) {
    if (const auto signal = interrupt.requested())
      throw tools::Interrupted(*signal, fmt::format("interrupted after {} of {} frames, no {}", frames, total,
                                                    arguments.options.out.string()));
    show_progress(frames, total, shown);
  });
  fmt::print("{}\n", arguments.options.out.string());
}

void add_time_options(CLI::App& command, view::FilmOptions& options) {
  command.add_option("--from", options.from_s, "Simulated time at which a film or strip begins")
      ->type_name("SECONDS");
  command.add_option("--to", options.to_s, "Simulated time at which it ends")->type_name("SECONDS");
  CLI::Option* at =
      command.add_option("--at", options.at_s, "Time of a picture; several give a strip: 3.2,4,4.8")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->type_name("SECONDS");
  command
      .add_option("--frames", options.instants, "A strip of this many instants, evenly from --from to --to")
      ->check(CLI::Range(1, 64))
      ->excludes(at);
  command
      .add_option("--fps", options.frames_per_s,
                  "Frames per second of a film (default: 30; GIF and WebP: 20)")
      ->check(CLI::Range(1.0, 100.0));
  command.add_option("--speed", options.speed, "Simulated seconds per second of film")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
}

void add_camera_options(CLI::App& command, RenderArguments& arguments) {
  command
      .add_option("--camera", arguments.camera,
                  "follow: beside the robot (default); fixed: with all of its path in view; orbit: around it")
      ->check(CLI::IsMember({"follow", "fixed", "orbit"}))
      ->type_name("NAME");
  command
      .add_option("--view", arguments.view, "Direction: front, side (from the left), top or iso (default)")
      ->check(CLI::IsMember(view_names()))
      ->type_name("NAME");
  command.add_option("--azimuth", arguments.azimuth_deg, "Direction: 0 from ahead of x, 90 from the left")
      ->type_name("DEGREES");
  command.add_option("--elevation", arguments.elevation_deg, "Height of the camera above the horizon")
      ->check(CLI::Range(-90.0, 90.0))
      ->type_name("DEGREES");
  command
      .add_option("--distance", arguments.options.camera.distance_m,
                  "Distance of the camera (default: the robot fills the picture)")
      ->check(CLI::Range(0.05, 100.0))
      ->type_name("METRES");
  command
      .add_option("--target", arguments.target_m, "Point in the world that stays in the middle: 0.5,0,0.2")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  command.add_option("--turn-rate", arguments.turn_deg_per_s, "Degrees per second with --camera orbit")
      ->capture_default_str();
}

}  // namespace

void add_render_command(CLI::App& program, Invocation& /*invocation*/) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = program.add_subcommand("render", "Draw pictures and films of a recorded run");
  command->footer(
      R"(Needs no display. The extension of --out selects the kind:
  .mp4         film
  .gif, .webp  film for a web page, 640x360
  .png         the instant --at, or several side by side: --at 1,2,3 or --frames 6
Films need the package ffmpeg.

Examples:
  koboshi render runs/walk --out walk.mp4
  koboshi render runs/walk --out step.png --at 6.4 --overlay zmp,com,contacts,support
  koboshi render runs/walk --out steps.png --frames 8 --from 6 --to 7.4 --view side
  koboshi render runs/walk --out boxes.gif --boxes --camera orbit --to 8 --speed 0.5
)");
  view::FilmOptions& options = arguments->options;
  command->add_option("RUN", arguments->run, "The folder of a run's results, or its file run.mcap")
      ->required();
  command->add_option("-o,--out", options.out, "The file to write")->required()->type_name("FILE");
  command
      ->add_option("--size", arguments->size,
                   "Size in pixels, of each instant in a strip (default: 1280x720)")
      ->type_name("WIDTHxHEIGHT");
  add_time_options(*command, options);
  add_camera_options(*command, *arguments);
  command
      ->add_option("--overlay", arguments->overlays,
                   "What to show besides the robot\n(default: time,events,zmp,footprints,pushes,legend)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(overlay_names()))
      ->type_name("NAMES");
  command->add_flag("--boxes", options.collisions, "Draw the shapes that collide, not those that are seen");
  command->add_flag("--translucent", options.translucent, "Show overlays through the robot");
  command->callback([arguments] { render_run(*arguments); });
}

}  // namespace koboshi::cli
