#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "lab/cluster/shard.h"
#include "lab/cluster/shard_run.h"
#include "lab/tune/study.h"

namespace koboshi::lab {

enum class Method {
  kCmaEs,  // maximises the mean score of all trials
  kNsga2,  // finds the Pareto front of the trials' scores
};

struct StudyOptions : SearchOptions {
  Method method = Method::kCmaEs;
  // CMA-ES only: populations that search beside each other, each from the start with random numbers of its
  // own. The evaluations are those of all of them.
  std::size_t islands = 1;
  // Generations after which each island takes the best candidate of the one before it as its mean, if that is
  // better than all of its own. 0: never.
  std::size_t migrate = 10;
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

// The same search in shards, each of which plays its part of every generation (search_trials.h). CMA-ES only.

// A hash of all on which the trials of the start depend.
[[nodiscard]] std::string study_inputs(const Study& study, const StudyOptions& options);

// Plays a shard until the search has ended. The folder of the options gets its trials only. Returns the best
// that was found.
SearchResult play_study_shard(const Study& study, const StudyOptions& options, const Shard& shard,
                              const ShowProgress& progress);

// Leaves the files that search_study leaves with one job. Throws InputError if trials are missing; the folder
// is then unchanged.
[[nodiscard]] SearchResult merge_study(const Study& study, const StudyOptions& options, std::size_t shards,
                                       const ShowProgress& progress);

// How far the shards are: each has a part of the generations that are not complete.
[[nodiscard]] std::vector<ShardProgress> study_progress(const Study& study, const StudyOptions& options,
                                                        std::size_t shards);

}  // namespace koboshi::lab
