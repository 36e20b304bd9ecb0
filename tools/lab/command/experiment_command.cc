#include "tools/cli/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tools/lab/catalogue/gyro_feedback.h"
#include "tools/lab/command/experiment_session.h"
#include "tools/lab/command/recovery_experiments.h"
#include "tools/lab/command/tune_gait_command.h"
#include "tools/lab/command/walking_experiments.h"
#include "tools/lab/experiment/report.h"
#include "tools/run/run.h"

namespace koboshi::tools {
namespace {

struct GyroFeedbackArguments {
  ExperimentArguments common;
  GyroFeedbackOptions options;
  std::string feedback = "both";
};

// The paper's figure 8, off beside on: the first seed's walks of 8 points (or of what there is), each with
// everything that `koboshi run` leaves of it. Markdown that shows them on the page; empty without a page.
std::string draw_figures(const GyroFeedbackArguments& arguments) {
  const GyroFeedbackOptions& options = arguments.options;
  const bool has_eight = std::ranges::find(options.points, 8) != options.points.end();
  const int points = has_eight ? 8 : options.points.front();
  Row names;
  Row images;
  for (const bool feedback : options.feedback) {
    const SeededWorld world =
        seeded_world(gyro_feedback_scenario(options, points, feedback), options, options.first_seed);
    const std::string name = gyro_feedback_cell(points, feedback);
    const std::filesystem::path folder = arguments.common.out / name;
    const RunResult walk = run({.scenario = world.scenario, .out = folder, .change = world.change}, {});
    if (walk.plot_warning) fmt::print(stderr, "koboshi: no figures: {}\n", *walk.plot_warning);
    if (arguments.common.page.empty() || !std::filesystem::exists(folder / "zmp.png")) continue;
    const std::string image = arguments.common.section + "-" + name + ".png";
    std::filesystem::copy_file(folder / "zmp.png", arguments.common.page.parent_path() / image,
                               std::filesystem::copy_options::overwrite_existing);
    names.push_back(fmt::format("{} points, feedback {}", points, feedback ? "on" : "off"));
    images.push_back(fmt::format("![ZMP trace over the feet]({})", image));
  }
  return names.empty() ? std::string() : table_text(names, {images}, TableStyle::kMarkdown);
}

void play_gyro_feedback(GyroFeedbackArguments arguments, const std::string& command_line) {
  GyroFeedbackOptions& options = arguments.options;
  options.overrides = overrides(arguments.common);
  options.first_seed = arguments.common.first_seed;
  options.seeds = arguments.common.seeds;
  if (arguments.feedback != "both") options.feedback = {arguments.feedback == "on"};
  const Experiment experiment = make_gyro_feedback(options);
  if (arguments.common.out.empty()) arguments.common.out = std::filesystem::path("runs") / experiment.name;
  if (arguments.common.section.empty()) arguments.common.section = experiment.name;
  const ExperimentResult result = play_with_progress(
      arguments.common, [&](const ExperimentOptions& how) { return play_experiment(experiment, how); });
  leave_results(experiment, result, arguments.common);
  write_page(experiment, result, arguments.common, "Gyro feedback and the number of points", command_line,
             draw_figures(arguments));
}

void add_gyro_feedback(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<GyroFeedbackArguments>();
  GyroFeedbackOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(
      "gyro-feedback", "The paper's section 3: points of the walking pattern, gyro feedback off and on");
  command->footer(
      "Every seed makes a world of its own: friction 0.5 to 1, link masses +-5 %, a floor that tilts up to\n"
      "1 degree, the sensors' noise and bias. The table shows shares and means with 95 % intervals.\n\n"
      "Examples:\n"
      "  koboshi experiment gyro-feedback --seeds 20 --duration 30\n"
      "  koboshi experiment gyro-feedback --points 8 --feedback on --seeds 100 --duration 60 --json fb.json\n"
      "  koboshi experiment gyro-feedback --disturbed --budget-s 1800\n");
  command->add_option("SCENARIO", options.scenario, "A scenario that walks")->capture_default_str();
  add_experiment_options(*command, arguments->common);
  command->add_option("--duration", arguments->common.duration, "Simulated seconds of a trial");
  command->add_option("--points", options.points, "Into which a cycle of two steps is divided: 4,8,16")
      ->delimiter(',')
      ->check(CLI::Range(2, 64));
  command->add_option("--feedback", arguments->feedback, "off, on or both")
      ->check(CLI::IsMember({"off", "on", "both"}))
      ->capture_default_str();
  add_disturbance_options(*command, options);
  command->add_option("--gaits", options.gaits,
                      "Folder with a gait for each cell: 8-on.yaml, ... (default: the scenario's in all)");
  command
      ->add_option("--falls-within", options.falls_within,
                   "End a cell early where its share of falls is known to within +- this")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->callback([arguments, command_line] { play_gyro_feedback(*arguments, command_line); });
}

}  // namespace

void add_experiment_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("experiment", "Experiments: many trials over the cores, with statistics");
  command->require_subcommand(1);
  add_gyro_feedback(*command, invocation.command_line);
  add_walking_experiments(*command, invocation.command_line);
  add_recovery_experiments(*command, invocation.command_line);
  add_tune_gait_command(*command);
}

}  // namespace koboshi::tools
