#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "lab/cluster/shard.h"
#include "lab/cluster/shard_run.h"
#include "lab/experiment/experiment.h"

namespace koboshi::lab {

// A trial of a generation of a search or of a training. The candidates are experiments that differ by their
// inputs, or cells of an experiment for each generation.
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

// How the trials are named in files, and the numbers that each has there.
struct TrialFormat {
  std::string experiment{};
  std::vector<Metric> metrics{};
};

// Plays them in `jobs` threads and keeps none.
[[nodiscard]] std::unique_ptr<SearchTrials> make_passing_trials(std::size_t jobs);

// Plays them in `jobs` threads. Finished trials are kept in a file and looked up there. Throws InputError if
// another program writes to it.
[[nodiscard]] std::unique_ptr<SearchTrials> make_local_trials(const std::filesystem::path& log,
                                                              const TrialFormat& format, std::size_t jobs);

// Each shard of a search runs the same strategy. It plays its part of a generation, keeps it in its file and
// takes the other parts from the files of the other shards: the generation is a barrier. A shard that has
// waited for twice as long as its own part took, and for a second, plays what is missing, which shards may
// have left that died or that the queue has not started.
[[nodiscard]] std::unique_ptr<SearchTrials> make_shard_trials(const std::filesystem::path& folder,
                                                              const Shard& shard, const TrialFormat& format,
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
                                                               std::size_t shards, const TrialFormat& format,
                                                               const std::filesystem::path& log);

// For what is asked of a search without playing: `play` throws TrialsMissing.
[[nodiscard]] std::unique_ptr<SearchTrials> make_no_trials();

// Calls `merge` with a new folder inside of `folder`, whose files move into `folder` once it has returned:
// the results of a merge are there whole or not at all. Locks `folder`. Turns TrialsMissing into an
// InputError that says how far the search has come, by `so_far`: "40 of 2000 candidates".
void merge_into(const std::filesystem::path& folder,
                const std::function<void(const std::filesystem::path&)>& merge,
                const std::function<std::string()>& so_far);

// How far the shards of a folder are, if the search needs `left` more trials in all. 0: it is complete.
[[nodiscard]] std::vector<ShardProgress> search_progress(const std::filesystem::path& folder,
                                                         std::size_t shards, std::size_t left);

}  // namespace koboshi::lab
