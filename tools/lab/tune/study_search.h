#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/lab/tune/study.h"

namespace koboshi::tools {

enum class Search {
  kCmaEs,  // for the largest mean worth of all trials
  kNsga2,  // for the worth of each trial, where none gets more but at another's cost
};

struct StudyOptions {
  Search search = Search::kCmaEs;
  std::vector<sim::Override> overrides{};  // of the scenario, in all trials
  std::filesystem::path out;               // folder of the log and the result
  std::uint64_t first_seed = 9000;
  std::size_t seeds = 3;
  std::size_t evaluations = 200;
  std::size_t population = 8;
  double spread = 0.15;
  std::size_t jobs = 1;
};

struct StudyProgress {
  std::size_t done = 0;
  std::size_t total = 0;
  double worth = 0.0;
  double best = 0.0;
};

struct StudyResult {
  std::vector<std::pair<std::string, double>> numbers;  // by path
  double worth = 0.0;  // mean over trials and seeds that were searched on: more than it will get on others
  std::size_t evaluations = 0;
  std::map<std::string, std::size_t> infeasible{};  // candidates by the limit that they violate
};

// The files on which the trials of a study depend, each once: its own, and those of every trial's scenario.
[[nodiscard]] std::vector<std::filesystem::path> study_files(const Study& study,
                                                             std::span<const sim::Scenario> trials);

// Searches for the numbers of a study with the same worlds in each evaluation. Leaves in the folder:
// evaluations.csv and trials.jsonl, from which an interrupted search resumes; best.yaml, the numbers
// of the largest mean worth as a scenario has them; report.md with figure.png, what they are and what each
// trial is worth with them; front.csv, of NSGA-II, the evaluations that no other beats in every trial. A
// candidate that violates a limit of the robot or of a parameter is worth less than any other and is counted;
// only the start must be feasible. Throws sim::InputError.
[[nodiscard]] StudyResult search_study(const Study& study, const StudyOptions& options,
                                       const std::function<void(const StudyProgress&)>& progress);

}  // namespace koboshi::tools
