#include "base/file/standard_streams.h"
#include "cli/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/lab/session.h"
#include "lab/bench/bench.h"
#include "lab/bench/report.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/paths.h"

namespace koboshi::cli {
namespace {

struct BenchArguments {
  lab::BenchOptions options{.walk = "scenarios/walk.yaml",
                            .squat = "scenarios/squat.yaml",
                            .lie = "scenarios/rise.yaml",
                            .steppers = {}};
  std::vector<std::string> names;
  double reference_step_ms = 0.05;
  std::filesystem::path json;
};

std::vector<lab::BenchStepper> chosen(const std::vector<std::string>& names) {
  std::vector<lab::BenchStepper> steppers = lab::bench_steppers();
  std::erase_if(steppers, [&](const lab::BenchStepper& stepper) {
    return !names.empty() && std::ranges::find(names, stepper.name) == names.end();
  });
  return steppers;
}

void play_bench(BenchArguments arguments) {
  for (std::filesystem::path* scenario :
       {&arguments.options.walk, &arguments.options.squat, &arguments.options.lie})
    *scenario = simulation::find_input(simulation::InputKind::kScenario, *scenario);
  arguments.options.steppers = chosen(arguments.names);
  arguments.options.reference_step_s = 1e-3 * arguments.reference_step_ms;
  const std::vector<lab::BenchResult> results = lab::bench(
      arguments.options, [](const std::string& what) { print_error("koboshi: bench: {}\n", what); });
  fmt::print("{}", lab::bench_table(results));
  if (!arguments.json.empty()) simulation::write_json(arguments.json, lab::bench_json(results));
}

}  // namespace

void add_bench_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<BenchArguments>();
  CLI::App* command = program.add_subcommand("bench", "How fast and how accurate each stepper is");
  command->footer(
      "Plays a walk, squats, a standing and a lying robot in closed loop with every stepper, in turns of a\n"
      "quarter of a second, and the squats once more at a fine step as the reference. Times are of the\n"
      "processor. Takes some minutes.\n\n"
      "Examples:\n"
      "  koboshi bench\n"
      "  koboshi bench --json bench.json\n"
      "  koboshi bench --steppers world,lumped --duration 5 --reference-step-ms 0.25\n");
  std::vector<std::string> known;
  for (const lab::BenchStepper& stepper : lab::bench_steppers()) known.push_back(stepper.name);
  command->add_option("--steppers", arguments->names, "Only these (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember(known));
  add_number(*command, "--duration", arguments->options.duration_s, 1.0, 600.0,
             "Simulated seconds of each scenario");
  command->add_option("--reference-step-ms", arguments->reference_step_ms, "Physics step of the reference")
      ->check(CLI::IsMember({0.01, 0.02, 0.025, 0.05, 0.1, 0.2, 0.25, 0.5, 1.0}))
      ->capture_default_str();
  command->add_option("--json", arguments->json, "Also write the results to this file");
  command->callback([arguments] { play_bench(*arguments); });
}

}  // namespace koboshi::cli
