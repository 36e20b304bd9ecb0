#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studio/parameters/parameter_document.h"
#include "studio/parameters/parameter_table.h"

namespace koboshi::studio {

// The settings of `koboshi tune`.
struct StudySettings {
  std::filesystem::path study;
  std::filesystem::path out;
  std::size_t evaluations = 200;
  std::size_t population = 8;
  std::size_t seeds = 3;
  std::uint64_t first_seed = 9000;
  double spread = 0.15;
  std::string search = "cma-es";
  std::string stepper{};  // empty: the scenario's
  std::size_t jobs = 0;   // 0: the number of cores
};

// Arguments of the program `koboshi` for them. The same ones resume an interrupted search.
[[nodiscard]] std::vector<std::string> tune_arguments(const StudySettings& settings);

// The studies in a folder, by name; files that are none are left out.
[[nodiscard]] std::vector<std::filesystem::path> find_studies(const std::filesystem::path& folder);

// An evaluated set of parameters: a row of evaluations.csv.
struct StudyEvaluation {
  std::size_t number = 0;        // from 1
  std::vector<double> values{};  // by StudyRun::paths
  std::vector<std::optional<double>> trial_scores{};
  std::optional<double> score{};  // nothing: infeasible
  std::string violated{};         // the limit that makes it so
};

// The state of a search, running or not, by its folder of results.
struct StudyRun {
  StudySettings settings;
  bool is_finished = false;
  bool is_running = false;           // a program holds the folder
  std::vector<std::string> paths{};  // of the parameters in the scenario
  std::vector<std::string> trials{};
  std::vector<StudyEvaluation> evaluations{};

  // The evaluation with the highest score; null without a feasible one.
  const StudyEvaluation* best() const;
  // The best evaluations, best first.
  std::vector<const StudyEvaluation*> best(std::size_t count) const;
};

// Reads search.json and evaluations.csv (docs/reference/study-format.md), up to the last whole row. Nothing
// if the folder holds no search. Throws InputError for a file that is damaged.
[[nodiscard]] std::optional<StudyRun> read_study_run(const std::filesystem::path& folder);

// The values of an evaluation that a document can take over, and the paths of those that it cannot.
struct Adoption {
  std::vector<ParameterValue> values{};
  std::vector<std::string> left_out{};
};
[[nodiscard]] Adoption adoption(const StudyRun& run, const StudyEvaluation& evaluation, ParameterTable table);

}  // namespace koboshi::studio
