#include "tools/lab/command/experiment_session.h"

#include <fmt/core.h>
#include <unistd.h>

#include "sim_board/input/error.h"
#include "sim_board/record/output_file.h"
#include "sim_board/record/summary.h"
#include "sim_board/world/options.h"
#include "simulation/batch/parallel.h"
#include "tools/cli/options.h"
#include "tools/lab/experiment/files.h"
#include "tools/lab/experiment/report.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLogName = "trials.jsonl";

// A folder of something else is left alone.
void check_folder(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) throw sim::InputError(folder, 0, "a file", "a folder for the results");
  if (fs::is_empty(folder) || fs::exists(folder / kLogName)) return;
  throw sim::InputError(folder, 0, "a folder with other files",
                        "a new or empty folder, or one of an earlier experiment");
}

void check_file(const fs::path& file) {
  if (file.empty()) return;
  const fs::path folder = fs::absolute(file).parent_path();
  if (!fs::is_directory(folder))
    throw sim::InputError(file, 0, "no folder to write it in", "one that exists");
}

std::string table_of(const Experiment& experiment, const ExperimentResult& result,
                     const Conclusions& conclusions, TableStyle style) {
  return conclusions.table ? conclusions.table(style) : result_table(experiment, result, style);
}

}  // namespace

void add_experiment_options(CLI::App& command, ExperimentArguments& arguments) {
  arguments.jobs = simulation::core_count();
  command.add_option("--seeds", arguments.seeds, "How many seeds each cell is played with")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command.add_option("--first-seed", arguments.first_seed, "The first of them")->capture_default_str();
  command.add_option("--stepper", arguments.stepper, "Of the physics in all cells, as in koboshi run")
      ->check(CLI::IsMember(sim::stepper_names()));
  command.add_option("--set", arguments.sets, "Override a key of the scenario in all cells; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--jobs", arguments.jobs, "Trials at a time (default: the number of cores)")
      ->check(CLI::Range(1, 1024));
  command.add_option("--budget-s", arguments.budget_s, "Seconds after which no more trials begin")
      ->check(CLI::PositiveNumber);
  command.add_option("--out", arguments.out,
                     "Folder of the results; resumes the experiment if the folder holds an interrupted one");
  command.add_option("--json", arguments.json, "Also write the results to this file");
  CLI::Option* page =
      command.add_option("--page", arguments.page, "Update this Markdown page with the results");
  command.add_option("--section", arguments.section, "The page's section that they replace")->needs(page);
}

void add_disturbance_options(CLI::App& command, GyroFeedbackOptions& options) {
  CLI::Option* disturbed = command.add_flag("--disturbed", options.disturbed,
                                            "Push the trunk; soft ground that tilts up to 3 degrees");
  command.add_option("--push", options.push_N_s, "The strongest push of the disturbed form, in N s")
      ->needs(disturbed)
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
}

std::vector<sim::Override> overrides(const ExperimentArguments& arguments) {
  return overrides_of(arguments.sets, {{"duration_s", arguments.duration, "--duration"},
                                       {"physics.stepper", arguments.stepper, "--stepper"}});
}

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (terminal_) fmt::print(stderr, "\n");
}

void ProgressLine::show(const ExperimentProgress& progress) {
  if (!terminal_) return;
  const double done = static_cast<double>(progress.done);
  const double left_min = progress.wall_s / 60.0 * (static_cast<double>(progress.total) / done - 1.0);
  fmt::print(stderr, "\r{} of {} trials, {:.1f} min, at most {:.1f} min to go ", progress.done,
             progress.total, progress.wall_s / 60.0, left_min);
  std::fflush(stderr);
}

ExperimentOptions options_of(const ExperimentArguments& arguments, ProgressLine& line) {
  check_folder(arguments.out);
  check_file(arguments.json);
  check_file(arguments.page);
  fs::create_directories(arguments.out);
  ExperimentOptions options{.log = arguments.out / kLogName, .jobs = arguments.jobs};
  if (arguments.budget_s > 0.0) options.budget = std::chrono::duration<double>(arguments.budget_s);
  options.progress = [&line](const ExperimentProgress& progress) { line.show(progress); };
  return options;
}

void leave_results(const Experiment& experiment, const ExperimentResult& result,
                   const ExperimentArguments& arguments, const Conclusions& conclusions) {
  nlohmann::ordered_json json = to_json(experiment, result);
  json.update(conclusions.values);
  sim::write_whole_file(arguments.out / "trials.csv", to_csv(experiment, result));
  sim::write_json(arguments.out / "result.json", json);
  if (!arguments.json.empty()) sim::write_json(arguments.json, json);
  fmt::print("{}{}{}results in {}\n", table_of(experiment, result, conclusions, TableStyle::kTerminal),
             conclusions.lines, notes(experiment, result), arguments.out.string());
}

void write_page(const Experiment& experiment, const ExperimentResult& result,
                const ExperimentArguments& arguments, const std::string& title,
                const std::string& command_line, const std::string& figures, const Conclusions& conclusions) {
  if (arguments.page.empty()) return;
  std::string text = fmt::format("\n```console not-run\n$ {}\n```\n\n{}", command_line,
                                 table_of(experiment, result, conclusions, TableStyle::kMarkdown));
  const std::string remarks = conclusions.lines + notes(experiment, result);
  if (!remarks.empty()) text += "\n```\n" + remarks + "```\n";
  if (!figures.empty()) text += "\n" + figures;
  write_section(arguments.page, title, arguments.section, text + "\n");
}

}  // namespace koboshi::tools
