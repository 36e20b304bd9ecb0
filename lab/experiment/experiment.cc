#include "lab/experiment/experiment.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "lab/experiment/ladder.h"
#include "lab/experiment/statistics.h"
#include "lab/experiment/trial_log.h"
#include "simulation/batch/parallel.h"

namespace koboshi::lab {
namespace {

using Clock = std::chrono::steady_clock;

bool has_too_many(const Experiment& experiment, const CellResult& cell) {
  for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
    const Metric& metric = experiment.metrics[i];
    if (!metric.is_event || metric.max_share >= 1.0) continue;
    if (estimate_share(values_of(cell, i)).events > max_events(metric, experiment.seeds)) return true;
  }
  return false;
}

bool is_tight(const Experiment& experiment, const CellResult& cell) {
  bool considered = false;
  for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
    const Metric& metric = experiment.metrics[i];
    if (metric.tight_at <= 0.0) continue;
    considered = true;
    const std::vector<double> values = values_of(cell, i);
    const Interval interval =
        metric.is_event ? estimate_share(values).confidence_95 : estimate_mean(values).confidence_95;
    if (!(interval.half_width() <= metric.tight_at)) return false;
  }
  return considered;
}

// Seeds go in batches over all cells that are still open, seeds outermost, so that a budget that runs out
// leaves every cell with about as many trials. A cell is judged after whole batches only, and trials begin
// in order: neither the number of threads nor how long a trial takes decides which ones count.
class Session {
 public:
  Session(const Experiment& experiment, const ExperimentOptions& options)
      : experiment_(experiment), options_(options), log_(options.log, experiment) {
    result_.cells.assign(experiment.cells.size(), {.stop = Stop::kNotReached});
  }

  ExperimentResult play() {
    if (experiment_.ladders.empty()) {
      std::vector<std::size_t> all(experiment_.cells.size());
      std::iota(all.begin(), all.end(), std::size_t{0});
      play_cells(std::move(all));
    }
    for (std::size_t level = 0; play_level(level); ++level) {
    }
    return std::move(result_);
  }

 private:
  // False when no ladder goes on.
  bool play_level(std::size_t level) {
    std::vector<std::size_t> cells;
    for (const Ladder& ladder : experiment_.ladders) {
      if (level >= ladder.cells.size()) continue;
      if (level == 0 || is_passed(result_.cells[ladder.cells[level - 1]])) {
        cells.push_back(ladder.cells[level]);
      }
    }
    if (cells.empty()) return false;
    play_cells(std::move(cells));
    return true;
  }

  void play_cells(std::vector<std::size_t> open) {
    total_ += open.size() * experiment_.seeds;
    for (const std::size_t cell : open) result_.cells[cell].stop = Stop::kAllSeeds;
    out_of_time_ = false;
    for (std::size_t begin = 0; begin < experiment_.seeds && !out_of_time_; begin += options_.batch) {
      play_batch(open, begin, std::min(begin + options_.batch, experiment_.seeds));
      std::erase_if(open, [this](std::size_t cell) { return closes(result_.cells[cell]); });
    }
  }

  void play_batch(const std::vector<std::size_t>& open, std::size_t begin, std::size_t end) {
    std::vector<Trial> trials;
    for (std::size_t i = begin; i < end; ++i) {
      for (const std::size_t cell : open) trials.push_back({cell, experiment_.first_seed + i});
    }
    const std::size_t started = simulation::for_each_parallel(
        trials.size(), options_.jobs, [&](std::size_t number) { finish(trials[number]); },
        [&] { return Clock::now() - start_ < options_.budget; });
    out_of_time_ = started < trials.size();
    for (std::size_t number = 0; number < trials.size(); ++number) {
      CellResult& cell = result_.cells[trials[number].cell];
      if (number < started) {
        cell.played.push_back(std::move(trials[number]));
      } else {
        cell.stop = Stop::kBudget;
      }
    }
  }

  void finish(Trial& trial) {
    if (auto known = log_.find(trial.cell, trial.seed)) {
      trial.record = std::move(*known);
    } else {
      trial.record = experiment_.play(trial.cell, trial.seed);
      log_.add(trial);
    }
    const std::lock_guard lock(mutex_);
    ++done_;
    if (!options_.progress) return;
    const std::chrono::duration<double> wall = Clock::now() - start_;
    options_.progress({done_, total_, wall.count()});
  }

  bool closes(CellResult& cell) const {
    const std::optional<Stop> stop = early_stop(experiment_, cell);
    if (!stop || (*stop == Stop::kTightEnough && out_of_time_)) return false;
    cell.stop = *stop;
    return true;
  }

  const Experiment& experiment_;
  const ExperimentOptions& options_;
  TrialLog log_;
  const Clock::time_point start_ = Clock::now();
  ExperimentResult result_;
  bool out_of_time_ = false;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
};

}  // namespace

ExperimentResult play_experiment(const Experiment& experiment, const ExperimentOptions& options) {
  return Session(experiment, options).play();
}

std::size_t max_events(const Metric& metric, std::size_t seeds) {
  return static_cast<std::size_t>(std::floor(metric.max_share * static_cast<double>(seeds) + 1e-9));
}

std::optional<Stop> early_stop(const Experiment& experiment, const CellResult& cell) {
  if (has_too_many(experiment, cell)) return Stop::kTooMany;
  if (cell.played.size() < experiment.seeds && is_tight(experiment, cell)) return Stop::kTightEnough;
  return std::nullopt;
}

std::vector<double> values_of(const CellResult& cell, std::size_t metric) {
  std::vector<double> values;
  for (const Trial& trial : cell.played) {
    if (const std::optional<double> value = trial.record.values.at(metric)) values.push_back(*value);
  }
  return values;
}

}  // namespace koboshi::lab
