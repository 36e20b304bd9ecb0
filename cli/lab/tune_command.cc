#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "base/file/output_file.h"
#include "cli/commands.h"
#include "cli/lab/session.h"
#include "cli/lab/shard_options.h"
#include "cli/lab/tune_gait_command.h"
#include "cli/options.h"
#include "lab/cluster/job_file.h"
#include "lab/tune/gait_search.h"
#include "lab/tune/infeasible.h"
#include "lab/tune/study_search.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"

namespace koboshi::cli {
namespace {

struct TuneArguments {
  std::filesystem::path study;
  lab::StudyOptions options;
  std::string search = "cma-es";
  std::string stepper;
  std::string robot;
  ShardArguments shards{};
};

struct TuneGaitArguments {
  lab::GaitSearchOptions options;
  int points = 8;
  std::string feedback = "on";
  std::string duration = "10";
  std::string stepper;
  std::string robot;
  std::filesystem::path result;
};

void add_search_options(CLI::App& command, lab::SearchOptions& options, std::size_t min_evaluations,
                        std::string& stepper, std::string& robot) {
  add_number(command, "--evaluations", options.evaluations, min_evaluations, 1'000'000,
             "Candidates that are tried; one that rounds to an earlier one counts, but is not played again");
  add_number(command, "--spread", options.spread, 0.001, 0.5,
             "Standard deviation of the first candidates about the start, as a share of the ranges");
  add_number(command, "--seeds", options.seeds, 1, 1000, "Worlds in which each candidate is tried");
  add_first_seed_option(command, options.first_seed, "The first of them; judge the result on others");
  add_stepper_option(command, stepper,
                     "Stepper of the physics: mujoco is fast; confirm what it finds with world");
  add_robot_option(command, robot);
  add_jobs_option(command, options.jobs);
}

// Prints the result of `search`, which is given a function that shows its progress.
template <typename Run>
auto show_search(const std::string& label, const std::string& unit, const std::filesystem::path& out,
                 const Run& run) {
  const auto result = [&] {
    const ProgressLine line;
    return run([&](const lab::SearchProgress& progress) {
      line.show(fmt::format("{} of {} candidates, {} evaluated, {}{:.4f}{}, best {:.4f}{}",
                            progress.done.candidates, progress.total, progress.done.evaluated, label,
                            progress.score, unit, progress.best, unit));
    });
  }();
  for (const auto& [path, value] : result.numbers) fmt::print("{}: {}\n", path, value);
  fmt::print("{}{}", lab::infeasible_text(result.infeasible, result.counts.candidates), result.lost);
  fmt::print("{}{:.4f}{} on the seeds that it was tuned on; {}; results in {}\n", label, result.score, unit,
             lab::counts_text(result.counts), out.string());
  return result;
}

// Plays or merges the shards that --shard and --shards name.
void tune_in_shards(const lab::Study& study, const lab::StudyOptions& options, const ShardArguments& shards,
                    Invocation& invocation) {
  const std::size_t count = shards.count(options.out);
  lab::keep_job(options.out, {lab::job_command(invocation.arguments), std::filesystem::current_path(), count,
                              lab::study_inputs(study, options)});
  if (shards.is_merge()) {
    show_search("score ", "", options.out,
                [&](const lab::ShowProgress& show) { return lab::merge_study(study, options, count, show); });
  } else if (!shards.action.empty()) {
    invocation.exit_status = show_shards(shards, lab::study_progress(study, options, count));
  } else {
    const ProgressLine line;
    const lab::SearchResult result =
        lab::play_study_shard(study, options, *shards.shard, [&line](const lab::SearchProgress& progress) {
          line.show(fmt::format("{} of {} candidates", progress.done.candidates, progress.total));
        });
    fmt::print("shard {} of {}: the search has ended after {}\n", shards.shard->number, count,
               lab::counts_text(result.counts));
  }
}

void tune(const TuneArguments& arguments, Invocation& invocation) {
  const lab::Study study =
      lab::read_study(simulation::find_input(simulation::InputKind::kStudy, arguments.study));
  lab::StudyOptions options = arguments.options;
  options.method = arguments.search == "cma-es" ? lab::Method::kCmaEs : lab::Method::kNsga2;
  if (!arguments.stepper.empty())
    options.overrides.push_back({"physics.stepper", arguments.stepper, "--stepper"});
  if (!arguments.robot.empty()) options.overrides.push_back(simulation::robot_override(arguments.robot));
  if (options.out.empty()) options.out = "runs/tune" / arguments.study.stem();
  warn_of_left_out(simulation::read_scenario(study.scenario, options.overrides));
  if (arguments.shards.is_used()) return tune_in_shards(study, options, arguments.shards, invocation);
  show_search("score ", "", options.out,
              [&](const lab::ShowProgress& show) { return lab::search_study(study, options, show); });
}

void tune_gait(const TuneGaitArguments& arguments) {
  check_output_file(arguments.result);
  lab::GaitSearchOptions options = arguments.options;
  options.experiment.scenario =
      simulation::find_input(simulation::InputKind::kScenario, options.experiment.scenario);
  options.start = simulation::find_input(simulation::InputKind::kGait, options.start);
  options.experiment.points = {arguments.points};
  options.experiment.feedback = {arguments.feedback == "on"};
  options.experiment.overrides =
      overrides_of({.duration = arguments.duration, .stepper = arguments.stepper, .robot = arguments.robot});
  if (options.out.empty())
    options.out = "runs/tune-gait/" + lab::gyro_feedback_cell(arguments.points, arguments.feedback == "on");
  const lab::GaitSearchResult result =
      show_search("", " m/s", options.out,
                  [&](const lab::ShowProgress& show) { return lab::search_gait(options, show); });
  if (!arguments.result.empty()) write_whole_file(arguments.result, result.text);
}

}  // namespace

void add_tune_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<TuneArguments>();
  CLI::App* command = program.add_subcommand("tune", "Optimise the parameters of a study");
  command->footer(
      "CMA-ES or NSGA-II over parameters of a scenario: of the controller, of a gait, or of the world. Each\n"
      "evaluation plays the study's trials in the same worlds. An interrupted search resumes when it is\n"
      "called again. docs/reference/study-format.md describes the file.\n\n"
      "Example:\n"
      "  koboshi tune studies/walk.yaml --stepper mujoco --evaluations 400\n");
  command->add_option("STUDY", arguments->study, "The study's file or name")->required();
  command
      ->add_option(
          "--search", arguments->search,
          "Maximises the mean score (cma-es) or finds the Pareto front of the trials' scores (nsga-2)")
      ->check(CLI::IsMember({"cma-es", "nsga-2"}))
      ->capture_default_str();
  add_search_options(*command, arguments->options, 16, arguments->stepper, arguments->robot);
  add_number(*command, "--population", arguments->options.population, 5, 1000, "Candidates of a generation");
  command->add_option("--out", arguments->options.out,
                      "Folder of the results (default: runs/tune/ and the study's name)");
  add_number(*command, "--islands", arguments->options.islands, 1, 1000,
             "Populations of CMA-ES that search beside each other and share the evaluations");
  add_number(*command, "--migrate", arguments->options.migrate, 0, 1'000'000,
             "Generations after which islands take over the best of another one; 0: never");
  add_shard_options(*command, arguments->shards);
  command->callback([arguments, &invocation] { tune(*arguments, invocation); });
}

void add_tune_gait_command(CLI::App& experiment) {
  auto arguments = std::make_shared<TuneGaitArguments>();
  lab::GaitSearchOptions& options = arguments->options;
  options.start = "robots/koboshi/gait.yaml";
  options.evaluations = 150;
  CLI::App* command = experiment.add_subcommand(
      "tune-gait", "Optimise the parameters of a gait: the robot walks fast and does not fall");
  command->footer(
      "CMA-ES, started from a gait file; keys that it does not have, and the gains where the feedback is\n"
      "off, are left alone. All cases get the same number of candidates, each on the same worlds. An\n"
      "interrupted search resumes when it is called again. evaluations.csv in the folder of the results\n"
      "lists every candidate.\n\n"
      "Example:\n"
      "  koboshi experiment tune-gait --points 8 --feedback off --gait robots/koboshi/gaits/8-off.yaml\n");
  command->add_option("SCENARIO", options.experiment.scenario, "File or name of a scenario that walks")
      ->capture_default_str();
  add_number(*command, "--points", arguments->points, 2, 64, "Points of a cycle of two steps");
  command->add_option("--feedback", arguments->feedback, "off or on")
      ->check(CLI::IsMember({"off", "on"}))
      ->capture_default_str();
  add_disturbance_options(*command, options.experiment);
  command
      ->add_option("--start", options.start,
                   "The gait file to begin with, or the name of a robot for its gait")
      ->capture_default_str();
  command->add_option("--gait", arguments->result, "Also write the gait that was found to this file");
  add_search_options(*command, options, 24, arguments->stepper, arguments->robot);
  command->add_option("--duration", arguments->duration, "Simulated seconds of a trial")
      ->capture_default_str();
  command->add_option("--out", options.out,
                      "Folder of the results (default: runs/tune-gait/ and the case's name)");
  command->callback([arguments] { tune_gait(*arguments); });
}

}  // namespace koboshi::cli
