#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "lab/cluster/shard.h"
#include "lab/experiment/experiment.h"

namespace koboshi::lab {

// A trial of a generation of a search. Each candidate has an experiment of its own, which differs from the
// others by its inputs.
struct SearchTrial {
  const Experiment* experiment = nullptr;
  Trial trial{};
};

// Called with the number of each trial whose record is known, once, one call at a time.
using TrialFinished = std::function<void(std::size_t)>;

// Where a search gets the records of its trials from. They depend on the trials alone: with every source, a
// search finds the same.
class SearchTrials {
 public:
  virtual ~SearchTrials() = default;

  // Sets the records of all trials of a generation.
  virtual void play(std::vector<SearchTrial>& trials, const TrialFinished& finished) = 0;
};

// Plays them in `jobs` threads. Finished trials are kept in a file and looked up there. Throws InputError if
// another program writes to it.
[[nodiscard]] std::unique_ptr<SearchTrials> make_local_trials(const std::filesystem::path& log,
                                                              const std::vector<Metric>& metrics,
                                                              std::size_t jobs);

// Each shard of a search runs the same strategy. It plays its part of a generation, keeps it in its file and
// takes the other parts from the files of the other shards: the generation is a barrier. A shard that has
// waited for twice as long as its own part took, and for a second, plays what is missing, which shards may
// have left that died or that the queue has not started.
[[nodiscard]] std::unique_ptr<SearchTrials> make_shard_trials(const std::filesystem::path& folder,
                                                              const Shard& shard,
                                                              const std::vector<Metric>& metrics,
                                                              std::size_t jobs);

// A merge has met trials that no shard has played.
struct TrialsMissing : std::runtime_error {
  TrialsMissing(std::size_t missing_trials, std::size_t all_trials)
      : std::runtime_error("trials are missing"), missing(missing_trials), all(all_trials) {}
  std::size_t missing;  // of the generation
  std::size_t all;
};

// Takes them from the files of all shards and writes them into a new file, in their order; an empty `log` is
// none. `play` throws TrialsMissing.
[[nodiscard]] std::unique_ptr<SearchTrials> make_merged_trials(const std::filesystem::path& folder,
                                                               std::size_t shards,
                                                               const std::vector<Metric>& metrics,
                                                               const std::filesystem::path& log);

}  // namespace koboshi::lab
