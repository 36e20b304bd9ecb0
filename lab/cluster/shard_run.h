#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "lab/cluster/shard.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/trial_store.h"

namespace koboshi::lab {

// An experiment in shards. Its trials in the order of seeds, those of a seed in the order of cells, are
// divided into consecutive parts, so that a shard is a range of seeds. A shard keeps its finished trials in
// its file and knows those of the others from theirs.
//
// Rules that stop a cell early (Metric::max_share, Metric::tight_at, ladders) are evaluated at the merge,
// over the trials in the order in which one program would have played them. Before it, they only save work:
// a shard does not play a trial that the merge will not need, whatever the missing trials are.

struct ShardProgress {
  std::size_t finished = 0;   // trials of the shard that are known
  std::size_t remaining = 0;  // trials of the shard that are neither known nor superfluous

  [[nodiscard]] bool is_complete() const { return remaining == 0; }
};

// The trials that all shards of a folder have finished.
class ShardedTrials {
 public:
  // `experiment` outlives this object. `batch` is that of the engine.
  ShardedTrials(const Experiment& experiment, std::filesystem::path folder, std::size_t shards,
                std::size_t batch = ExperimentOptions{}.batch);

  // Reads the lines that were added to the files. Throws InputError.
  void refresh();
  // Counts a trial of this program before its file is read.
  void add(const Trial& trial);

  [[nodiscard]] const Record* find(std::size_t cell, std::uint64_t seed) const {
    return store_.find(experiment_, cell, seed);
  }
  // False if the rules stop the cell before this seed, whatever trials are still missing.
  [[nodiscard]] bool is_needed(std::size_t cell, std::uint64_t seed) const;
  [[nodiscard]] bool has_stopping_rule() const { return has_stopping_rule_; }
  [[nodiscard]] ShardProgress progress(std::size_t shard) const;
  // The trials of the experiment in the files that another program, or the same with other files, played.
  [[nodiscard]] std::size_t count_of_others() const { return store_.count_of_others(experiment_.inputs); }

 private:
  struct CellState {
    std::vector<std::size_t> easier{};                // cells of its ladder
    std::vector<std::set<std::size_t>> events{};      // by metric: places of the seeds that had them
    CellResult beginning{.stop = Stop::kNotReached};  // the known trials before the first missing one
    std::size_t end = 0;                              // no seed from this place on is needed
    bool has_failed = false;                          // no harder cell is needed
  };

  void judge(std::size_t cell, const Trial& trial);
  void judge_beginning(std::size_t cell);

  const Experiment& experiment_;
  const std::filesystem::path folder_;
  const std::size_t shards_;
  const std::size_t batch_;
  bool has_stopping_rule_ = false;
  bool has_tight_rule_ = false;
  TrialStore store_;
  std::vector<std::uintmax_t> offsets_;  // by shard: bytes that were read
  std::vector<CellState> cells_;
  std::set<std::pair<std::size_t, std::uint64_t>> judged_{};
};

struct ShardOptions {
  std::size_t jobs = 1;  // threads
  // No trial begins when this has passed; those under way are finished.
  std::chrono::duration<double> budget = std::chrono::duration<double>::max();
  // How long the files of other shards are not read again. They are read only if the experiment can stop
  // early. 0.5 s for each shard keeps the look-ups of N shards at 2 N a second: a file server of a cluster
  // answers some 10,000. It is a matter of work that is saved, not of results.
  std::chrono::duration<double> refresh_after = std::chrono::duration<double>::max();
  std::function<void(const ShardProgress&)> progress{};  // after each trial, one call at a time
};

// Plays what a shard's file does not hold yet. Throws InputError if another program plays the same shard, and
// what a trial throws; finished trials stay in the file.
ShardProgress play_shard(const Experiment& experiment, const std::filesystem::path& folder,
                         const Shard& shard, const ShardOptions& options);

// The result that one program alone gets, from the files of the shards. Writes the trials into `log` as that
// program with one thread writes them. May be repeated. Throws InputError, which names the shards that miss
// trials, if one is needed that is missing; `log` is then unchanged.
[[nodiscard]] ExperimentResult merge_shards(const Experiment& experiment, const std::filesystem::path& folder,
                                            std::size_t shards, const std::filesystem::path& log);

// "3 (2 of 5 trials), 7 (0 of 5 trials)": the shards that are not complete; at most ten, then "and 12 more".
[[nodiscard]] std::string incomplete_text(const std::vector<ShardProgress>& shards);

}  // namespace koboshi::lab
