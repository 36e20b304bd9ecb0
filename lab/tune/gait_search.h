#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lab/catalogue/gyro_feedback.h"
#include "lab/tune/search.h"

namespace koboshi::lab {

// The parameters of the gait file that the search may change, for the legs of the robot koboshi; the start is
// not set. A search leaves alone parameters that its gait file does not name, and the gains of the feedback
// while it is off.
[[nodiscard]] std::vector<SearchedNumber> gait_parameters();

// The score of a walk, as a speed in m/s. A walk that fell gets less than any that did not, more the longer
// it lasted; of the others slow walks, and walks that drift or slide, get less. `duration_s` is that of a
// trial that nothing ended.
[[nodiscard]] double reward(const ScenarioTrial& trial, double duration_s);

struct GaitSearchOptions : SearchOptions {
  GyroFeedbackOptions experiment{};  // one number of points, feedback off or on; its seeds are not used
  std::filesystem::path start{};     // the gait file that the search begins with
};

struct GaitSearchResult : SearchResult {
  std::string text{};  // of the gait file
};

// Searches for the parameters of one case with the same worlds in each evaluation. Leaves evaluations.csv
// (each evaluation, its parameters, its reward), trials.jsonl, from which an interrupted search resumes, and
// gait.yaml in the folder. A gait that violates a limit of the robot counts as a fall at once and is counted.
// Throws InputError.
[[nodiscard]] GaitSearchResult search_gait(const GaitSearchOptions& options, const ShowProgress& progress);

}  // namespace koboshi::lab
