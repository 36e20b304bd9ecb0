#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim_board/input/yaml_tree.h"
#include "tools/lab/catalogue/gyro_feedback.h"
#include "tools/lab/experiment/experiment.h"
#include "tools/lab/experiment/report.h"

namespace koboshi::tools {

// The options that every experiment has.
struct ExperimentArguments {
  std::size_t seeds = 20;
  std::uint64_t first_seed = 1;
  std::string duration;
  std::string stepper;
  std::vector<std::string> sets;
  std::size_t jobs = 1;
  double budget_s = 0.0;  // 0: none
  std::filesystem::path out;
  std::filesystem::path json;
  std::filesystem::path page;
  std::string section;
};

// Adds them to a subcommand.
void add_experiment_options(CLI::App& command, ExperimentArguments& arguments);

// Adds --disturbed and --push, to whatever plays the worlds of the gyro-feedback experiment.
void add_disturbance_options(CLI::App& command, GyroFeedbackOptions& options);

// What --duration, --stepper and --set ask for.
[[nodiscard]] std::vector<sim::Override> overrides(const ExperimentArguments& arguments);

// A line on a terminal, nothing in a pipe.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  void show(const ExperimentProgress& progress);

 private:
  bool terminal_;
};

// How to play: with the line, and finished trials in trials.jsonl in the folder. Checks where the results are
// to go, and makes the folder. Throws sim::InputError.
[[nodiscard]] ExperimentOptions options_of(const ExperimentArguments& arguments, ProgressLine& line);

// What `play` returns of these options.
template <typename Play>
[[nodiscard]] auto play_with_progress(const ExperimentArguments& arguments, const Play& play) {
  ProgressLine line;
  return play(options_of(arguments, line));
}

// Prints the table and leaves trials.csv and result.json in the folder, and what --json asks for.
void leave_results(const Experiment& experiment, const ExperimentResult& result,
                   const ExperimentArguments& arguments, const Conclusions& conclusions = {});

// The table with the command that made it, as a section of the page that --page asks for; `figures` is
// Markdown that follows the table.
void write_page(const Experiment& experiment, const ExperimentResult& result,
                const ExperimentArguments& arguments, const std::string& title,
                const std::string& command_line, const std::string& figures,
                const Conclusions& conclusions = {});

}  // namespace koboshi::tools
