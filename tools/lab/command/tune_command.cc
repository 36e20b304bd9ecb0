#include "tools/cli/commands.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>

#include "sim_board/world/options.h"
#include "simulation/batch/parallel.h"
#include "tools/lab/tune/infeasible.h"
#include "tools/lab/tune/study_search.h"

namespace koboshi::tools {
namespace {

struct TuneArguments {
  std::filesystem::path study;
  StudyOptions options;
  std::string search = "cma-es";
  std::string stepper;
};

void tune(TuneArguments arguments) {
  const Study study = read_study(arguments.study);
  StudyOptions& options = arguments.options;
  options.search = arguments.search == "cma-es" ? Search::kCmaEs : Search::kNsga2;
  if (!arguments.stepper.empty())
    options.overrides.push_back({"physics.stepper", arguments.stepper, "--stepper"});
  if (options.out.empty()) options.out = "runs/tune" / arguments.study.stem();
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const StudyResult result = search_study(study, options, [&](const StudyProgress& progress) {
    if (!terminal) return;
    fmt::print(stderr, "\r{} of {} evaluations, worth {:.4f}, best {:.4f} ", progress.done, progress.total,
               progress.worth, progress.best);
    std::fflush(stderr);
  });
  if (terminal) fmt::print(stderr, "\n");
  for (const auto& [path, value] : result.numbers) fmt::print("{}: {}\n", path, value);
  fmt::print("{}", infeasible_text(result.infeasible, result.evaluations));
  fmt::print("worth {:.4f} on the seeds that it was tuned on; results in {}\n", result.worth,
             options.out.string());
}

}  // namespace

void add_tune_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<TuneArguments>();
  StudyOptions& options = arguments->options;
  options.jobs = simulation::core_count();
  CLI::App* command = program.add_subcommand("tune", "Optimise the parameters of a study");
  command->footer(
      "CMA-ES or NSGA-II over numbers of a scenario: parameters of the controller, of a gait, or of the "
      "world. "
      "Each\n"
      "evaluation plays the study's trials in the same worlds. A search that was interrupted goes on when it "
      "is called "
      "again.\n"
      "docs/reference/study-format.md describes the file.\n\n"
      "Example:\n"
      "  koboshi tune studies/walk.yaml --stepper mujoco --evaluations 400\n");
  command->add_option("STUDY", arguments->study, "The study's file")->required();
  command
      ->add_option("--search", arguments->search,
                   "For the largest mean worth (cma-es), or for each trial's (nsga-2)")
      ->check(CLI::IsMember({"cma-es", "nsga-2"}))
      ->capture_default_str();
  command->add_option("--evaluations", options.evaluations, "How many sets of numbers are tried")
      ->check(CLI::Range(16, 1'000'000))
      ->capture_default_str();
  command->add_option("--population", options.population, "Of them in a generation")
      ->check(CLI::Range(5, 1000))
      ->capture_default_str();
  command
      ->add_option("--spread", options.spread,
                   "How widely the first lie about the start, as a share of the ranges")
      ->check(CLI::Range(0.001, 0.5))
      ->capture_default_str();
  command->add_option("--seeds", options.seeds, "Worlds in which each is tried")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--first-seed", options.first_seed, "The first of them; take others to judge the result")
      ->capture_default_str();
  command
      ->add_option("--stepper", arguments->stepper,
                   "Of the physics: mujoco is fast; confirm what it finds with world")
      ->check(CLI::IsMember(sim::stepper_names()));
  command->add_option("--jobs", options.jobs, "Trials at a time (default: the number of cores)")
      ->check(CLI::Range(1, 1024));
  command->add_option("--out", options.out,
                      "Folder of the results (default: runs/tune/ and the study's name)");
  command->callback([arguments] { tune(*arguments); });
}

}  // namespace koboshi::tools
