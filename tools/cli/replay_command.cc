#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "tools/cli/commands.h"
#include "tools/view/gltf/gltf.h"
#include "tools/view/recording/read_recording.h"

namespace koboshi::tools {
namespace {

struct ReplayArguments {
  std::filesystem::path run;
  std::filesystem::path gltf;
};

void describe(const view::Recording& recording, const std::filesystem::path& run) {
  const double end_s =
      recording.samples.empty() ? 0.0 : 1e-6 * static_cast<double>(recording.samples.back().time_us);
  fmt::print("{}: {} of {}, {:.2f} s, {}, {}, seed {}, stepper {}{}\n", run.string(), recording.title,
             recording.scene.robot, end_s, sim::count_text(recording.samples.size(), "sample"),
             sim::count_text(recording.frames.size(), "frame"), recording.seed, recording.stepper,
             recording.complete ? "" : "; interrupted: up to its last whole block");
}

void replay(const ReplayArguments& arguments) {
  const view::Recording recording = view::read_recording(arguments.run);
  describe(recording, arguments.run);
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
  command->callback([arguments] { replay(*arguments); });
}

}  // namespace koboshi::tools
