#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/core.h>

#include "base/file/overwrite.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "view/gltf/gltf.h"
#include "view/recording/read_recording.h"
#include "view/replay/replay_page.h"

namespace koboshi::cli {
namespace {

struct ReplayArguments {
  std::filesystem::path run;
  std::filesystem::path gltf;
  std::filesystem::path html;
  std::filesystem::path other;
  bool make_page = false;
};

void make_page(const ReplayArguments& arguments, const view::Recording& recording) {
  std::filesystem::path file = arguments.html;
  if (file.empty()) {
    const bool is_folder = std::filesystem::is_directory(arguments.run);
    file = (is_folder ? arguments.run : arguments.run.parent_path()) / "replay.html";
  }
  std::optional<view::Recording> other;
  if (!arguments.other.empty()) other = view::read_recording(arguments.other);
  view::write_replay_page(recording, other ? &*other : nullptr, view::network_of(recording, network_of({})),
                          file);
  fmt::print("replay page in {}\n", file.string());
}

void describe(const view::Recording& recording, const std::filesystem::path& run) {
  const double end_s =
      recording.samples.empty() ? 0.0 : 1e-6 * static_cast<double>(recording.samples.back().time_us);
  fmt::print("{}: {} of {}, {:.2f} s, {}, {}, seed {}, stepper {}{}\n", run.string(), recording.title,
             recording.scene.robot, end_s, count_text(recording.samples.size(), "sample"),
             count_text(recording.frames.size(), "frame"), recording.seed, recording.stepper,
             recording.complete ? "" : "; interrupted: up to its last whole block");
}

void replay(const ReplayArguments& arguments) {
  for (const std::filesystem::path& out : {arguments.html, arguments.gltf})
    for (const std::filesystem::path& run : {arguments.run, arguments.other})
      if (!run.empty()) refuse_to_overwrite({run, run / "run.mcap"}, out);
  const view::Recording recording = view::read_recording(arguments.run);
  describe(recording, arguments.run);
  warn_of_meshes(recording);
  if (arguments.make_page) make_page(arguments, recording);
  if (!arguments.gltf.empty()) {
    view::write_gltf(recording, arguments.gltf);
    fmt::print("animation in {}\n", arguments.gltf.string());
  }
}

}  // namespace

void add_replay_command(CLI::App& program, Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = program.add_subcommand("replay", "Show a recorded run elsewhere");
  command->footer(
      R"(Describes the recording of a run (run.mcap, docs/reference/recording.md) and converts it.

Example:
  koboshi replay runs/host --gltf walk.glb
)");
  command->add_option("RUN", arguments->run, "The folder of a run's results, or its file run.mcap")
      ->required();
  command->add_option("--gltf", arguments->gltf,
                      "Write shapes and motion as binary glTF 2.0, for Blender and others: walk.glb");
  CLI::Option* html =
      command
          ->add_option("--html", arguments->html,
                       "Write a page that shows the run in a browser, without server and network (default: "
                       "replay.html in the folder of the run)")
          ->expected(0, 1)
          ->type_name("FILE");
  command
      ->add_option("--with", arguments->other,
                   "A second run, which the page compares with the first: a folder or run.mcap")
      ->type_name("RUN")
      ->needs(html);
  command->callback([arguments, html] {
    arguments->make_page = html->count() > 0;
    replay(*arguments);
  });
}

}  // namespace koboshi::cli
