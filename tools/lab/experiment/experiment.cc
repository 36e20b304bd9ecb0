#include "tools/lab/experiment/experiment.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "simulation/batch/parallel.h"
#include "tools/lab/experiment/trial_log.h"

namespace koboshi::tools {
namespace {

using Clock = std::chrono::steady_clock;

// Seeds go in batches over all cells that are still open, seeds outermost, so that a budget that runs out
// leaves every cell with about as many trials. A cell is judged after whole batches only, and trials begin
// in order: neither the number of threads nor how long a trial takes decides which ones count.
class Session {
 public:
  Session(const Experiment& experiment, const ExperimentOptions& options)
      : experiment_(experiment), options_(options), log_(options.log, experiment) {
    result_.cells.resize(experiment.cells.size());
    open_.assign(experiment.cells.size(), true);
  }

  ExperimentResult play() {
    for (std::size_t begin = 0; begin < experiment_.seeds && !out_of_time_; begin += options_.batch) {
      play_batch(begin, std::min(begin + options_.batch, experiment_.seeds));
      close_cells();
    }
    return std::move(result_);
  }

 private:
  bool in_time() const { return Clock::now() - start_ < options_.budget; }

  void play_batch(std::size_t begin, std::size_t end) {
    std::vector<Trial> trials;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t cell = 0; cell < open_.size(); ++cell) {
        if (open_[cell]) trials.push_back({cell, experiment_.first_seed + i});
      }
    }
    const std::size_t started = simulation::for_each_parallel(
        trials.size(), options_.jobs, [&](std::size_t number) { finish(trials[number]); },
        [&] { return in_time(); });
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
    if (const auto known = log_.find(trial.cell, trial.seed)) {
      trial.values = *known;
    } else {
      trial.values = experiment_.play(trial.cell, trial.seed);
      std::erase_if(trial.values, [](const auto& value) { return !std::isfinite(value.second); });
      log_.add(trial);
    }
    const std::lock_guard lock(mutex_);
    ++done_;
    if (!options_.progress) return;
    const std::chrono::duration<double> wall = Clock::now() - start_;
    options_.progress({done_, experiment_.cells.size() * experiment_.seeds, wall.count()});
  }

  void close_cells() {
    for (std::size_t cell = 0; cell < open_.size(); ++cell) {
      if (!open_[cell]) continue;
      CellResult& played = result_.cells[cell];
      if (has_too_many(experiment_, played)) {
        played.stop = Stop::kTooMany;
      } else if (!out_of_time_ && played.played.size() < experiment_.seeds && is_tight(played)) {
        played.stop = Stop::kTightEnough;
      } else {
        continue;
      }
      open_[cell] = false;
    }
  }

  bool is_tight(const CellResult& cell) const {
    const auto tight = [&](const Measure& measure) {
      const Interval interval = measure.kind == Measure::Kind::kEvent ? share_of(cell, measure).confidence_95
                                                                      : mean_of(cell, measure).confidence_95;
      return interval.half_width() <= measure.tight_at;
    };
    const auto minded = [](const Measure& measure) { return measure.tight_at > 0.0; };
    return std::ranges::any_of(experiment_.measures, minded) &&
           std::ranges::all_of(experiment_.measures,
                               [&](const Measure& measure) { return !minded(measure) || tight(measure); });
  }

  const Experiment& experiment_;
  const ExperimentOptions& options_;
  TrialLog log_;
  const Clock::time_point start_ = Clock::now();
  ExperimentResult result_;
  std::vector<bool> open_;  // by cell
  bool out_of_time_ = false;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

}  // namespace

ExperimentResult play_experiment(const Experiment& experiment, const ExperimentOptions& options) {
  return Session(experiment, options).play();
}

std::vector<double> values_of(const CellResult& cell, const Measure& measure) {
  std::vector<double> values;
  for (const Trial& trial : cell.played) {
    const auto value = trial.values.find(measure.name);
    if (value != trial.values.end()) values.push_back(value->second);
  }
  return values;
}

bool has_too_many(const Experiment& experiment, const CellResult& cell) {
  return std::ranges::any_of(experiment.measures, [&](const Measure& measure) {
    if (measure.kind != Measure::Kind::kEvent || measure.most_share >= 1.0) return false;
    const double most = std::floor(measure.most_share * static_cast<double>(experiment.seeds) + 1e-9);
    return static_cast<double>(share_of(cell, measure).events) > most;
  });
}

ShareEstimate share_of(const CellResult& cell, const Measure& event) {
  const std::vector<double> values = values_of(cell, event);
  const auto events = std::ranges::count_if(values, [](double value) { return value != 0.0; });
  return estimate_share(static_cast<std::size_t>(events), values.size());
}

MeanEstimate mean_of(const CellResult& cell, const Measure& quantity) {
  return estimate_mean(values_of(cell, quantity));
}

}  // namespace koboshi::tools
