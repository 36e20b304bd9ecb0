#include "cli/commands.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <vector>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "cli/lab/session.h"
#include "lab/experiment/files.h"
#include "lab/validate/report.h"
#include "sim_board/world/options.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/paths.h"

namespace koboshi::cli {
namespace {

namespace fs = std::filesystem;

struct ValidateArguments {
  std::string stepper = sim_board::stepper_names().front();
  double step_ms = 1.0;
  lab::ValidationSetup setup;
  std::vector<std::string> only;
  fs::path out = "runs/validate";
  fs::path page;
  fs::path json;
};

void check_arguments(const ValidateArguments& arguments) {
  const double steps_a_ms = 1.0 / arguments.step_ms;
  if (std::abs(steps_a_ms - std::round(steps_a_ms)) > 1e-9) {
    throw InputError("--step-ms", 0, fmt::format("{}", arguments.step_ms), "a step that divides 1 ms");
  }
  check_output_file(arguments.page);
  check_output_file(arguments.json);
  check_output_folder(arguments.out);
}

// Prints why figures cannot be drawn, and then returns false.
bool draw_all(const std::vector<lab::ValidationResult>& results, const fs::path& folder) {
  try {
    for (const lab::ValidationResult& result : results) lab::draw_plots(result, folder);
    return true;
  } catch (const tools::PlotError& error) {
    print_error("koboshi: {}\n", error.what());
    return false;
  }
}

// Copies the figures into a folder beside the page, with the page's name.
void write_page(const std::vector<lab::ValidationResult>& results, const ValidateArguments& arguments,
                const std::string& command_line) {
  const fs::path figures = arguments.page.parent_path() / arguments.page.stem();
  fs::create_directories(figures);
  for (const lab::ValidationResult& result : results) {
    for (const lab::Plot& plot : result.findings.plots) {
      const std::string image = plot.name + ".png";
      fs::copy_file(arguments.out / image, figures / image, fs::copy_options::overwrite_existing);
    }
  }
  const std::string date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  lab::write_section(arguments.page, "Validation", "results",
                     lab::page_text(results, command_line, date, arguments.page.stem().string()));
}

int validate(ValidateArguments arguments, const std::string& command_line) {
  check_arguments(arguments);
  lab::ValidationSetup& setup = arguments.setup;
  setup.scenario = simulation::find_input(simulation::InputKind::kScenario, setup.scenario);
  for (const fs::path& out : {arguments.page, arguments.json}) refuse_to_overwrite({setup.scenario}, out);
  setup.world.step_s = 1e-3 * arguments.step_ms;
  setup.world.stepper = sim_board::stepper_named(arguments.stepper).value();
  std::vector<lab::ValidationResult> results;
  for (const lab::Validation& validation : lab::all_validations()) {
    if (!arguments.only.empty() && std::ranges::find(arguments.only, validation.name) == arguments.only.end())
      continue;
    results.push_back(lab::play(validation, setup));
    const lab::ValidationResult& result = results.back();
    fmt::print("{}{}\n{}", results.size() > 1 ? "\n" : "", result.validation.title,
               lab::check_table(result.findings.checks, TableStyle::kTerminal));
    std::fflush(stdout);
  }
  const OutputFolder folder(arguments.out);
  write_whole_file(arguments.out / "checks.csv", lab::to_csv(results));
  const bool drawn = !setup.short_form && draw_all(results, arguments.out);
  if (drawn && !arguments.page.empty()) write_page(results, arguments, command_line);
  if (!arguments.json.empty()) simulation::write_json(arguments.json, lab::to_json(results, setup));
  simulation::write_json(arguments.out / "summary.json",
                         lab::to_json(results, setup));  // last: the folder is complete
  const bool passed = std::ranges::all_of(results, &lab::ValidationResult::passed);
  fmt::print("\n{}; stepper {}, {} ms; results in {}\n",
             passed ? "all within tolerance" : "NOT within tolerance", arguments.stepper, arguments.step_ms,
             arguments.out.string());
  return passed ? 0 : 1;
}

}  // namespace

void add_validate_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<ValidateArguments>();
  CLI::App* command = program.add_subcommand("validate", "Compare the simulated physics with theory");
  std::vector<std::string> names;
  std::string list;
  for (const lab::Validation& validation : lab::all_validations()) {
    names.push_back(validation.name);
    list += fmt::format("  {:<18} {}\n", validation.name, validation.title);
  }
  command->footer("The experiments:\n" + list +
                  R"(Tolerances follow from the order of the method and the step. Exit status: 0 all within
tolerance, 1 not all, 2 bad arguments. docs/experiment/validation.md discusses the results.

Examples:
  koboshi validate
  koboshi validate --step-ms 0.1 --only pendulum --only servo
)");
  command->add_option("--stepper", arguments->stepper, "Solver of the equations of motion")
      ->check(CLI::IsMember(sim_board::stepper_names()))
      ->capture_default_str();
  command->add_option("--step-ms", arguments->step_ms, "Physics step, divides 1 ms")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--only", arguments->only, "Run only this experiment; may be repeated")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names));
  CLI::Option* brief =
      command->add_flag("--short", arguments->setup.short_form, "Shorter runs, and no figures");
  command
      ->add_option("--scenario", arguments->setup.scenario,
                   "File or name of the scenario of the squats of the whole robot")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Folder of the results")->capture_default_str();
  command->add_option("--page", arguments->page, "Update this Markdown page with the results")
      ->excludes(brief);
  command->add_option("--json", arguments->json, "Also write the results to this file");
  command->callback(
      [arguments, &invocation] { invocation.exit_status = validate(*arguments, invocation.command_line); });
}

}  // namespace koboshi::cli
