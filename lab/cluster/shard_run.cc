#include "lab/cluster/shard_run.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/text/error.h"
#include "lab/experiment/trial_log.h"
#include "simulation/batch/parallel.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;
using ShardClock = std::chrono::steady_clock;

// The merge has met a trial that no shard has played.
struct MissingTrial {};

// The cells that are played side by side, one level of all ladders after the other.
std::vector<std::vector<std::size_t>> levels_of(const Experiment& experiment) {
  std::vector<std::vector<std::size_t>> levels;
  if (experiment.ladders.empty()) {
    levels.emplace_back(experiment.cells.size());
    std::iota(levels.front().begin(), levels.front().end(), std::size_t{0});
  }
  for (const Ladder& ladder : experiment.ladders) {
    if (levels.size() < ladder.cells.size()) levels.resize(ladder.cells.size());
    for (std::size_t level = 0; level < ladder.cells.size(); ++level)
      levels[level].push_back(ladder.cells[level]);
  }
  return levels;
}

// Plays the trials of one shard.
class ShardPlayer {
 public:
  ShardPlayer(const Experiment& experiment, const fs::path& folder, const Shard& shard,
              const ShardOptions& options)
      : experiment_(experiment),
        shard_(shard),
        options_(options),
        trials_(experiment, folder, shard.count),
        log_(shard_file(folder, shard), experiment) {}

  ShardProgress play() {
    trials_.refresh();
    progress_ = trials_.progress(shard_.number);
    for (std::vector<std::size_t>& cells : levels_of(experiment_)) {
      std::ranges::sort(cells);
      std::vector<Trial> trials = own_trials(cells);
      const std::size_t started = simulation::for_each_parallel(
          trials.size(), options_.jobs, [&](std::size_t number) { finish(trials[number]); },
          [&] { return ShardClock::now() - start_ < options_.budget; });
      if (started < trials.size()) break;
    }
    trials_.refresh();
    return trials_.progress(shard_.number);
  }

 private:
  std::vector<Trial> own_trials(const std::vector<std::size_t>& cells) const {
    const ShardRange range = range_of(shard_, experiment_.cells.size() * experiment_.seeds);
    std::vector<Trial> trials;
    for (std::size_t item = range.begin; item < range.end; ++item) {
      const std::size_t cell = item % experiment_.cells.size();
      if (std::ranges::binary_search(cells, cell))
        trials.push_back({cell, experiment_.first_seed + item / experiment_.cells.size()});
    }
    return trials;
  }

  void finish(Trial& trial) {
    if (!is_to_be_played(trial)) return;
    trial.record = experiment_.play(trial.cell, trial.seed);
    log_.add(trial);
    const std::lock_guard lock(mutex_);
    trials_.add(trial);
    ++progress_.finished;
    --progress_.remaining;
    if (options_.progress) options_.progress(progress_);
  }

  bool is_to_be_played(const Trial& trial) {
    const std::lock_guard lock(mutex_);
    if (trials_.find(trial.cell, trial.seed) != nullptr) return false;
    if (!trials_.has_stopping_rule()) return true;
    const ShardClock::time_point now = ShardClock::now();
    if (now - refreshed_ >= options_.refresh_after) {
      trials_.refresh();
      refreshed_ = now;
    }
    return trials_.is_needed(trial.cell, trial.seed);
  }

  const Experiment& experiment_;
  const Shard shard_;
  const ShardOptions& options_;
  ShardedTrials trials_;
  TrialLog log_;
  const ShardClock::time_point start_ = ShardClock::now();
  ShardClock::time_point refreshed_ = start_;
  ShardProgress progress_{};  // without what the rules save meanwhile
  std::mutex mutex_;
};

}  // namespace

ShardedTrials::ShardedTrials(const Experiment& experiment, fs::path folder, std::size_t shards,
                             std::size_t batch)
    : experiment_(experiment),
      folder_(std::move(folder)),
      shards_(shards),
      batch_(batch),
      store_(experiment.name, experiment.metrics),
      offsets_(shards, 0),
      cells_(experiment.cells.size()) {
  for (CellState& cell : cells_) {
    cell.end = experiment.seeds;
    cell.events.resize(experiment.metrics.size());
  }
  for (const Ladder& ladder : experiment.ladders) {
    for (auto cell = ladder.cells.begin(); cell != ladder.cells.end(); ++cell)
      cells_[*cell].easier.assign(ladder.cells.begin(), cell);
  }
  for (const Metric& metric : experiment.metrics) {
    has_tight_rule_ = has_tight_rule_ || metric.tight_at > 0.0;
    has_stopping_rule_ = has_stopping_rule_ || has_tight_rule_ || (metric.is_event && metric.max_share < 1.0);
  }
}

void ShardedTrials::refresh() {
  for (std::size_t i = 0; i < shards_; ++i)
    offsets_[i] = store_.read(shard_file(folder_, {i + 1, shards_}), offsets_[i]);
  if (!has_stopping_rule_) return;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    for (std::size_t i = 0; i < experiment_.seeds; ++i) {
      const std::uint64_t seed = experiment_.first_seed + i;
      if (const Record* record = find(cell, seed)) judge(cell, {cell, seed, *record});
    }
    judge_beginning(cell);
  }
}

void ShardedTrials::add(const Trial& trial) {
  store_.add(experiment_, trial);
  if (has_stopping_rule_) judge(trial.cell, trial);
}

// A cell with too many events ends at the latest with the batch in which the last of the allowed ones and one
// more have happened: the trials that are missing can only add events. Where a cell may also end because its
// intervals are tight, it may do so before, and is then none that has failed.
void ShardedTrials::judge(std::size_t cell, const Trial& trial) {
  if (!judged_.insert({cell, trial.seed}).second || has_tight_rule_) return;
  CellState& state = cells_[cell];
  for (std::size_t i = 0; i < experiment_.metrics.size(); ++i) {
    const Metric& metric = experiment_.metrics[i];
    if (!metric.is_event || metric.max_share >= 1.0 || trial.record.values.at(i).value_or(0.0) == 0.0)
      continue;
    std::set<std::size_t>& events = state.events[i];
    events.insert(trial.seed - experiment_.first_seed);
    const std::size_t allowed = max_events(metric, experiment_.seeds);
    if (events.size() <= allowed) continue;
    state.has_failed = true;
    const std::size_t last = *std::next(events.begin(), static_cast<std::ptrdiff_t>(allowed));
    state.end = std::min(state.end, (last / batch_ + 1) * batch_);
  }
}

// Judges a cell as the engine does, as far as no trial is missing.
void ShardedTrials::judge_beginning(std::size_t cell) {
  CellState& state = cells_[cell];
  if (!has_tight_rule_ || state.end < experiment_.seeds) return;
  std::vector<Trial>& played = state.beginning.played;
  while (played.size() < experiment_.seeds) {
    const std::uint64_t seed = experiment_.first_seed + played.size();
    const Record* record = find(cell, seed);
    if (record == nullptr) return;
    played.push_back({cell, seed, *record});
    if (played.size() % batch_ != 0 && played.size() != experiment_.seeds) continue;
    const auto stop = early_stop(experiment_, state.beginning);
    if (!stop) continue;
    state.has_failed = *stop == Stop::kTooMany;
    state.end = played.size();
    return;
  }
}

bool ShardedTrials::is_needed(std::size_t cell, std::uint64_t seed) const {
  const CellState& state = cells_.at(cell);
  if (seed - experiment_.first_seed >= state.end) return false;
  return std::ranges::none_of(state.easier, [this](std::size_t easier) { return cells_[easier].has_failed; });
}

ShardProgress ShardedTrials::progress(std::size_t shard) const {
  ShardProgress progress;
  const std::size_t cells = experiment_.cells.size();
  const ShardRange range = range_of({shard, shards_}, cells * experiment_.seeds);
  for (std::size_t item = range.begin; item < range.end; ++item) {
    const std::uint64_t seed = experiment_.first_seed + item / cells;
    if (find(item % cells, seed) != nullptr) {
      ++progress.finished;
    } else if (is_needed(item % cells, seed)) {
      ++progress.remaining;
    }
  }
  return progress;
}

ShardProgress play_shard(const Experiment& experiment, const fs::path& folder, const Shard& shard,
                         const ShardOptions& options) {
  return ShardPlayer(experiment, folder, shard, options).play();
}

ExperimentResult merge_shards(const Experiment& experiment, const fs::path& folder, std::size_t shards,
                              const fs::path& log) {
  ShardedTrials trials(experiment, folder, shards);
  trials.refresh();
  Experiment known = experiment;
  known.play = [&trials](std::size_t cell, std::uint64_t seed) {
    const Record* record = trials.find(cell, seed);
    if (record == nullptr) throw MissingTrial();
    return *record;
  };
  fs::path beside = log;
  beside += ".merging";
  fs::remove(beside);  // of a merge that was killed
  try {
    ExperimentResult result = play_experiment(known, {.log = beside, .jobs = 1});
    fs::rename(beside, log);
    return result;
  } catch (const MissingTrial&) {
    fs::remove(beside);
  }
  std::vector<ShardProgress> progress;
  for (std::size_t i = 1; i <= shards; ++i) progress.push_back(trials.progress(i));
  const std::size_t others = trials.count_of_others();
  throw InputError(
      folder, 0,
      "incomplete shards: " + incomplete_text(progress) +
          (others == 0 ? "" : "; " + std::to_string(others) + " trials are of another program or files"),
      std::to_string(shards) + " complete ones (koboshi lab submit runs the missing ones)");
}

std::string incomplete_text(const std::vector<ShardProgress>& shards) {
  constexpr std::size_t kNamed = 10;
  std::string text;
  std::size_t count = 0;
  for (std::size_t i = 0; i < shards.size(); ++i) {
    if (shards[i].is_complete() || ++count > kNamed) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(i + 1) + " (" + std::to_string(shards[i].finished) +
            " of " + std::to_string(shards[i].finished + shards[i].remaining) + " trials)";
  }
  return count > kNamed ? text + " and " + std::to_string(count - kNamed) + " more" : text;
}

}  // namespace koboshi::lab
