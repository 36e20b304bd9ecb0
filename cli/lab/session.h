#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "cli/commands.h"
#include "cli/lab/shard_options.h"
#include "lab/catalogue/gyro_feedback.h"
#include "lab/experiment/report.h"

namespace koboshi::cli {

// Options of every experiment beside its setup.
struct SessionOptions {
  std::string duration{};
  std::string stepper{};
  std::string robot{};
  std::vector<std::string> sets{};
  std::size_t jobs = 1;
  double budget_s = 0.0;        // 0: none
  std::filesystem::path out{};  // empty: runs/ and the experiment's name
  std::filesystem::path json{};
  std::filesystem::path record_lost{};  // folder of the recordings of lost trials; empty: none
  std::filesystem::path page{};
  std::string section{};  // empty: the experiment's name
  ShardArguments shards{};
};

// Adds a number with its range; --help shows both and the default.
template <typename Number>
CLI::Option* add_number(CLI::App& command, const std::string& name, Number& value,
                        std::type_identity_t<Number> low, std::type_identity_t<Number> high,
                        const std::string& help) {
  return command.add_option(name, value, help)->check(CLI::Range(low, high))->capture_default_str();
}

// Adds --first-seed. Results hold seeds as numbers of JSON, which are exact below 2^53.
void add_first_seed_option(CLI::App& command, std::uint64_t& seed, const std::string& help);
// Throws InputError for a result that cannot be written: a file without a folder, or that is a folder itself.
void check_output_file(const std::filesystem::path& file);
void add_session_options(CLI::App& command, lab::ExperimentSetup& setup, SessionOptions& session);
void add_stepper_option(CLI::App& command, std::string& stepper, const std::string& help);
void add_jobs_option(CLI::App& command, std::size_t& jobs);
// Adds --disturbed and --push, to whatever plays the worlds of the gyro-feedback experiment.
void add_disturbance_options(CLI::App& command, lab::GyroFeedbackOptions& options);

// The overrides of --duration, --stepper and --set.
[[nodiscard]] std::vector<Override> overrides_of(const SessionOptions& session);

// A line of progress on standard error. Does nothing in a pipe.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  void show(const std::string& text) const;

 private:
  bool terminal_;
};

// Makes further figures, and returns Markdown that shows them on the page; empty without a page.
using DrawFigures = std::function<std::string(const SessionOptions&)>;

// Plays an experiment with finished trials in trials.jsonl in the folder, prints the table, and leaves
// trials.csv, result.json, figure.png and what --json and --page ask for. With --shard or --shards, does what
// they say; a merge leaves the same files. Throws InputError.
void conduct(const lab::Experiment& experiment, SessionOptions session, Invocation& invocation,
             const DrawFigures& draw_figures);

}  // namespace koboshi::cli
