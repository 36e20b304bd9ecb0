#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "lab/tune/study.h"

namespace koboshi::tools {

enum class Method {
  kCmaEs,  // maximises the mean score of all trials
  kNsga2,  // finds the Pareto front of the trials' scores
};

struct StudyOptions : SearchOptions {
  Method method = Method::kCmaEs;
};

// The files on which the trials of a study depend, each once: its own, and those of every trial's scenario.
[[nodiscard]] std::vector<std::filesystem::path> study_files(const Study& study,
                                                             std::span<const simulation::Scenario> trials);

// Searches for the numbers of a study with the same worlds in each evaluation. Leaves in the folder:
// evaluations.csv and trials.jsonl, from which an interrupted search resumes; search.json, its options and
// how far it is, written after each evaluation; best.yaml, the numbers of the largest mean score as a
// scenario has them; report.md with figure.png, what they are and what each trial scores with them;
// front.csv, of NSGA-II, the evaluations that no other beats in every trial. A candidate that violates a
// limit of the robot or of a parameter scores less than any other and is counted; only the start must be
// feasible. Throws InputError.
[[nodiscard]] SearchResult search_study(const Study& study, const StudyOptions& options,
                                        const ShowProgress& progress);

}  // namespace koboshi::tools
