#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tools/lab/catalogue/gyro_feedback.h"
#include "tools/lab/experiment/experiment.h"
#include "tools/lab/tune/gait_text.h"

namespace koboshi::tools {

// A number of the gait file that the search may change, and how far.
struct SearchedNumber {
  std::string key;  // dotted where it stands within a map
  double low = 0.0;
  double high = 0.0;
  bool gain = false;  // of the feedback: stays as it is while feedback is off
  // What it is a multiple of.
  double grid = 1e-5;
};

// Of the robot koboshi: about what its legs can do. A search leaves alone what its gait file does not name.
[[nodiscard]] std::vector<SearchedNumber> searched_numbers();

// How well a robot walked, to be made large, as a speed in m/s. One that fell gets less than any that did
// not, more the longer it walked; of the others the slower, the one that drifts and the one that slides get
// less. `duration_s` is what the trial would have lasted.
[[nodiscard]] double reward(const Values& values, double duration_s);

struct GaitSearchOptions {
  GyroFeedbackOptions
      experiment;               // one number of points, feedback off or on; its seeds are those searched on
  std::filesystem::path start;  // the gait file that the search begins with
  std::filesystem::path out;    // folder of the log and the result
  std::size_t evaluations = 150;
  double spread = 0.15;  // of the first gaits about the start: standard deviation, as a share of the ranges
  std::size_t jobs = 1;
};

struct GaitSearchProgress {
  std::size_t done = 0;
  std::size_t total = 0;
  double reward = 0.0;
  double best = 0.0;
};

struct GaitSearchResult {
  GaitNumbers numbers;
  double reward = 0.0;  // on the seeds that were searched on: more than it will get on others
  std::string text;     // of the gait file
  std::size_t evaluations = 0;
  std::map<std::string, std::size_t> infeasible{};  // candidates by the limit that they violate
};

// Searches for the numbers of one case with the same worlds in each evaluation. Leaves evaluations.csv (each
// evaluation, its numbers, its reward), trials.jsonl, from which an interrupted search resumes, and
// gait.yaml in the folder. A gait that violates a limit of the robot counts as a fall at once and is counted.
// Throws sim::InputError.
[[nodiscard]] GaitSearchResult search_gait(const GaitSearchOptions& options,
                                           const std::function<void(const GaitSearchProgress&)>& progress);

}  // namespace koboshi::tools
