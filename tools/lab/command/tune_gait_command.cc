#include "tools/lab/command/tune_gait_command.h"

#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>

#include "sim_board/record/output_file.h"
#include "sim_board/world/options.h"
#include "simulation/batch/parallel.h"
#include "tools/lab/command/experiment_session.h"
#include "tools/lab/tune/gait_search.h"
#include "tools/lab/tune/infeasible.h"

namespace koboshi::tools {
namespace {

struct TuneGaitArguments {
  GaitSearchOptions options;
  int points = 8;
  std::string feedback = "on";
  std::string duration = "10";
  std::string stepper;
  std::filesystem::path result;
};

void show(const GaitSearchProgress& progress) {
  fmt::print(stderr, "\r{} of {} evaluations, {:.4f} m/s, best {:.4f} m/s ", progress.done, progress.total,
             progress.reward, progress.best);
  std::fflush(stderr);
}

void tune_gait(TuneGaitArguments arguments) {
  GaitSearchOptions& options = arguments.options;
  options.experiment.points = {arguments.points};
  options.experiment.feedback = {arguments.feedback == "on"};
  options.experiment.overrides.push_back({"duration_s", arguments.duration, "--duration"});
  if (!arguments.stepper.empty()) {
    options.experiment.overrides.push_back({"physics.stepper", arguments.stepper, "--stepper"});
  }
  if (options.out.empty()) {
    options.out = "runs/tune-gait/" + gyro_feedback_cell(arguments.points, arguments.feedback == "on");
  }
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const GaitSearchResult result = search_gait(options, [&](const GaitSearchProgress& progress) {
    if (terminal) show(progress);
  });
  if (terminal) fmt::print(stderr, "\n");
  for (const auto& [key, value] : result.numbers) fmt::print("{}: {}\n", key, value);
  fmt::print("{}", infeasible_text(result.infeasible, result.evaluations));
  fmt::print("{:.4f} m/s on the seeds that it was tuned on; results in {}\n", result.reward,
             options.out.string());
  if (!arguments.result.empty()) sim::write_whole_file(arguments.result, result.text);
}

}  // namespace

void add_tune_gait_command(CLI::App& experiment) {
  auto arguments = std::make_shared<TuneGaitArguments>();
  GaitSearchOptions& options = arguments->options;
  options.start = "robots/koboshi/gait.yaml";
  options.experiment.first_seed = 9000;
  options.experiment.seeds = 3;
  options.jobs = simulation::core_count();
  CLI::App* command = experiment.add_subcommand(
      "tune-gait", "Search for the numbers of a gait with which the robot walks fast and does not fall");
  command->footer(
      "CMA-ES, started from a gait file; keys that it does not have, and the gains where the feedback is\n"
      "off, are left alone. All cases get the same number of evaluations, each on the same worlds. An\n"
      "interrupted search resumes when it is called again. evaluations.csv in the folder of the results\n"
      "lists every evaluation.\n\n"
      "Example:\n"
      "  koboshi experiment tune-gait --points 8 --feedback off --gait robots/koboshi/gaits/8-off.yaml\n");
  command->add_option("SCENARIO", options.experiment.scenario, "A scenario that walks")
      ->capture_default_str();
  command->add_option("--points", arguments->points, "Into which a cycle of two steps is divided")
      ->check(CLI::Range(2, 64))
      ->capture_default_str();
  command->add_option("--feedback", arguments->feedback, "off or on")
      ->check(CLI::IsMember({"off", "on"}))
      ->capture_default_str();
  add_disturbance_options(*command, options.experiment);
  command->add_option("--start", options.start, "The gait file to begin with")->capture_default_str();
  command->add_option("--gait", arguments->result, "Also write the gait that was found to this file");
  command->add_option("--evaluations", options.evaluations, "How many gaits are tried")
      ->check(CLI::Range(24, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--spread", options.spread,
                   "How widely the first gaits lie about the start, as a share of what each number may be")
      ->check(CLI::Range(0.001, 0.5))
      ->capture_default_str();
  command->add_option("--seeds", options.experiment.seeds, "Worlds in which each is tried")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--first-seed", options.experiment.first_seed,
                   "The first of them; take others for the experiment")
      ->capture_default_str();
  command->add_option("--duration", arguments->duration, "Simulated seconds of a trial")
      ->capture_default_str();
  command
      ->add_option("--stepper", arguments->stepper,
                   "Of the physics: mujoco is fast; confirm what it finds with world")
      ->check(CLI::IsMember(sim::stepper_names()));
  command->add_option("--jobs", options.jobs, "Trials at a time (default: the number of cores)")
      ->check(CLI::Range(1, 1024));
  command->add_option("--out", options.out,
                      "Folder of the results (default: runs/tune-gait/ and the case's name)");
  command->callback([arguments] { tune_gait(*arguments); });
}

}  // namespace koboshi::tools
