#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/lab/experiment/statistics.h"

namespace koboshi::tools {

// An experiment plays the same trial in several cells, such as feedback off and on, for a run of seeds each.
// A trial depends on its cell and seed alone, so that the results are the same in whatever order and on
// however many cores the trials are played.

// What is measured in a trial. Its values are SI, its name ends in their unit.
struct Measure {
  enum class Kind { kEvent, kQuantity };  // 0 or 1, of which shares are told; or a number

  std::string name;  // "speed_m_per_s", in CSV and JSON
  Kind kind = Kind::kQuantity;
  std::string label{};    // "speed [m/s]", in tables; empty: not in tables
  double factor = 1.0;    // from SI to the label's unit
  int decimals = 3;       // in tables
  double tight_at = 0.0;  // a cell stops where all its intervals are within +- this of SI; 0: never mind
  // Of an event: a cell stops where more than this share of all its seeds have had it.
  double most_share = 1.0;
};

struct Cell {
  std::string name;                                           // "8-on", unique in the experiment
  std::vector<std::pair<std::string, std::string>> settings;  // {"points", "8"}: the same names in all cells
};

// The values of a trial by the names of the measures. What has no finite value in this trial is left out.
struct Values : std::map<std::string, double> {
  using map::map;

  std::string error{};  // that ended the trial; empty without

  friend bool operator==(const Values&, const Values&) = default;
};

struct Experiment {
  std::string name;                 // "gyro-feedback"
  std::vector<Measure> measures{};  // the first column first
  std::vector<Cell> cells{};
  std::uint64_t first_seed = 1;
  std::size_t seeds = 1;                                          // of each cell, unless it stops early
  std::vector<std::pair<std::string, std::string>> conditions{};  // the same in all cells, for the reader
  std::string inputs{};  // a hash of whatever else a trial depends on
  // Plays the trial of a cell, by number, and a seed. Called from several threads at a time.
  std::function<Values(std::size_t cell, std::uint64_t seed)> play{};
};

struct Trial {
  std::size_t cell = 0;
  std::uint64_t seed = 0;
  Values values{};

  friend bool operator==(const Trial&, const Trial&) = default;
};

struct ExperimentProgress {
  std::size_t done = 0;   // trials, those of an earlier session included
  std::size_t total = 0;  // at most; cells may stop early
  double wall_s = 0.0;
};

struct ExperimentOptions {
  std::filesystem::path log{};  // where finished trials are kept and looked up; empty: nowhere
  std::size_t jobs = 1;         // threads
  std::size_t batch = 10;       // seeds after which a cell is asked whether its intervals are tight enough
  // No trial begins when this has passed; those under way are finished.
  std::chrono::duration<double> budget = std::chrono::duration<double>::max();
  std::function<void(const ExperimentProgress&)> progress{};  // after each trial, one call at a time
};

// Why a cell has no more trials.
enum class Stop { kAllSeeds, kTightEnough, kTooMany, kBudget };

struct CellResult {
  Stop stop = Stop::kAllSeeds;
  std::vector<Trial> played{};  // of consecutive seeds from the first
};

struct ExperimentResult {
  std::vector<CellResult> cells{};  // by cell
};

// Plays what the log does not hold yet. Rethrows what a trial throws, of several the first in the order of
// seeds; finished trials stay in the log.
[[nodiscard]] ExperimentResult play_experiment(const Experiment& experiment,
                                               const ExperimentOptions& options);

// The values of a measure in the trials that have one.
[[nodiscard]] std::vector<double> values_of(const CellResult& cell, const Measure& measure);
// Whether more trials than Measure::most_share allows had an event.
[[nodiscard]] bool has_too_many(const Experiment& experiment, const CellResult& cell);
[[nodiscard]] ShareEstimate share_of(const CellResult& cell, const Measure& event);
[[nodiscard]] MeanEstimate mean_of(const CellResult& cell, const Measure& quantity);

}  // namespace koboshi::tools
