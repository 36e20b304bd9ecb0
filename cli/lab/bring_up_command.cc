#include "cli/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/file/standard_streams.h"
#include "cli/lab/session.h"
#include "lab/bring_up/ladder.h"
#include "simulation/batch/parallel.h"
#include "simulation/disturbance/world_ranges.h"
#include "simulation/scenario/paths.h"
#include "tools/run/interrupt.h"

namespace koboshi::cli {
namespace {

struct BringUpArguments {
  lab::BringUpOptions options{.robot = {}, .reference = "robots/koboshi/robot.sdf"};
  double budget_min = 10.0;
};

int climb(BringUpArguments arguments) {
  lab::BringUpOptions& options = arguments.options;
  options.robot = simulation::find_input(simulation::InputKind::kRobot, options.robot);
  options.reference = simulation::find_input(simulation::InputKind::kRobot, options.reference);
  options.budget_s = 60.0 * arguments.budget_min;
  tools::Interrupt interrupt;
  std::atomic<int> signal = 0;
  options.go_on = [&] {
    if (const std::optional<int> arrived = interrupt.requested()) signal = *arrived;
    return signal == 0;
  };
  std::string last;
  try {
    const lab::BringUpResult result = lab::bring_up(options, [&](const std::string& line) {
      last = line;
      print_error("koboshi: bring-up: {}\n", line);
    });
    fmt::print("{}", lab::ladder_text(result));
    for (const std::filesystem::path& file : result.files) fmt::print("{}\n", file.string());
    const bool failed = std::ranges::any_of(
        result.rungs, [](const lab::Rung& rung) { return rung.result == lab::Rung::Result::kFailed; });
    return failed ? 1 : 0;
  } catch (const lab::Stopped&) {
    throw tools::Interrupted(signal,
                             "interrupted at " + last + "; the same command continues before this rung");
  }
}

}  // namespace

void add_bring_up_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<BringUpArguments>();
  lab::BringUpOptions& options = arguments->options;
  options.jobs = simulation::core_count();
  CLI::App* command =
      program.add_subcommand("bring-up", "From the model of a robot to one that stands and walks");
  command->footer(
      "Scales the parameters of a robot that walks to this one, makes its standing pose, and climbs a "
      "ladder: loads, hangs,\n"
      "stands, shifts its weight, squats, steps on the spot, walks forward, sideways, and turns. Where the "
      "scaled values do\n"
      "not carry the robot, a search tries others. After a rung that fails, those are tried that do not need "
      "it. Files go to\n"
      "the robot's folder at the end of each rung; bring-up.md has the figures. A second call repeats the "
      "rungs that failed\n"
      "and those whose inputs have changed. Exit status 1 if a rung fails.\n\n"
      "Example:\n"
      "  koboshi bring-up robots/kit\n");
  command->add_option("ROBOT", options.robot, "The robot's folder, file or name")->required();
  command->add_option("--reference", options.reference, "A robot that walks, whose parameters are scaled")
      ->capture_default_str();
  add_stepper_option(*command, options.stepper, "Stepper of the physics");
  command
      ->add_option("--world", options.world,
                   "Worlds in which the robots are tried (docs/reference/worlds.md)")
      ->check(CLI::IsMember(simulation::world_names()))
      ->capture_default_str();
  add_number(*command, "--seeds", options.seeds, 1, 1000, "Robots that each rung has to carry");
  add_first_seed_option(*command, options.first_seed, "Seed of the first of them");
  CLI::Option* budget =
      add_number(*command, "--budget", arguments->budget_min, 0.0, 1000.0, "Time for searches in minutes");
  command
      ->add_option("--candidates", options.candidates,
                   "Candidates of each search, instead of a time: the result repeats")
      ->check(CLI::Range(std::size_t{0}, std::size_t{100'000}))
      ->excludes(budget);
  command->add_flag("--restart", options.restart, "Begin anew, whatever an earlier call has reached");
  command->add_option("--until", options.until, "The last rung to try")
      ->type_name("RUNG")
      ->check(CLI::IsMember(lab::rung_names()));
  add_jobs_option(*command, options.jobs);
  command->callback([arguments, &invocation] { invocation.exit_status = climb(*arguments); });
}

}  // namespace koboshi::cli
