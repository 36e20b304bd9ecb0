#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace koboshi::lab {

// An experiment plays the same trial in several cells, such as feedback off and on, for a run of seeds each.
// A trial depends on its cell and seed alone, so that the results are the same in whatever order and on
// however many cores the trials are played.
//
// The engine sees a trial as a record of numbers, one for each metric. The experiment itself works with a
// struct of its own; a table of fields (lab/experiment/field_table.h) converts one into the other.

// Name and report format of a number of a trial. Its unit is SI.
struct Metric {
  std::string name;        // "speed_m_per_s", in CSV and JSON; ends in the unit
  std::string label{};     // "speed [m/s]", in tables; empty: not in tables
  int decimals = 3;        // in tables
  double factor = 1.0;     // from SI to the label's unit
  double tight_at = 0.0;   // a cell stops when each such interval is within +- this, in SI; 0: not considered
  double max_share = 1.0;  // of an event: a cell stops when more than this share of all its seeds have had it
  bool is_event = false;   // 0 or 1, reported as a share of the trials; otherwise a quantity
  bool is_loss = false;    // an event with which the trial is lost
};

struct Cell {
  std::string name;                                           // "8-on", unique in the experiment
  std::vector<std::pair<std::string, std::string>> settings;  // {"points", "8"}: the same names in all cells
};

// Cells of increasing difficulty: the engine plays the next one only if this one has not failed.
struct Ladder {
  std::string name;
  std::string unit;                // of the levels
  std::vector<std::size_t> cells;  // of the experiment, the easiest first
};

// The numbers of a trial, in the order of the metrics. Nothing where the trial has no finite value.
struct Record {
  std::vector<std::optional<double>> values{};
  std::string error{};  // that ended the trial; empty without

  friend bool operator==(const Record&, const Record&) = default;
};

struct Conclusions;       // lab/experiment/report.h
struct ExperimentResult;  // below

struct Experiment {
  std::string name;                                               // "gyro-feedback"
  std::string title{};                                            // of a page that begins with its results
  std::vector<Metric> metrics{};                                  // the first column first
  std::vector<Cell> cells{};                                      //
  std::vector<Ladder> ladders{};                                  // empty: all cells are played side by side
  std::uint64_t first_seed = 1;                                   //
  std::size_t seeds = 1;                                          // of each cell, unless it stops early
  std::vector<std::pair<std::string, std::string>> conditions{};  // the same in all cells, for the reader
  std::string inputs{};   // a hash of whatever else a trial depends on
  std::string warning{};  // for the reader, before the trials; empty: none
  // Plays the trial of a cell, by number, and a seed. Called from several threads at a time.
  std::function<Record(std::size_t cell, std::uint64_t seed)> play{};
  // Draws conclusions from the cells. May be empty.
  std::function<Conclusions(const Experiment&, const ExperimentResult&)> conclude{};
};

struct Trial {
  std::size_t cell = 0;
  std::uint64_t seed = 0;
  Record record{};
};

struct ExperimentProgress {
  std::size_t done = 0;   // trials, those of an earlier session included
  std::size_t total = 0;  // at most; cells may stop early
  double wall_s = 0.0;
};

struct ExperimentOptions {
  std::filesystem::path log{};  // where finished trials are kept and looked up; empty: nowhere
  std::size_t jobs = 1;         // threads
  std::size_t batch = 10;       // seeds after which the engine checks whether a cell's intervals are tight
  // No trial begins when this has passed; those under way are finished.
  std::chrono::duration<double> budget = std::chrono::duration<double>::max();
  std::function<void(const ExperimentProgress&)> progress{};  // after each trial, one call at a time
};

// Why a cell has no more trials.
enum class Stop {
  kAllSeeds,
  kTightEnough,
  kTooMany,     // more trials than Metric::max_share allows had an event
  kBudget,      // the time was over
  kNotReached,  // an easier cell of its ladder failed, or has not been finished; not part of the report
};

struct CellResult {
  Stop stop = Stop::kAllSeeds;
  std::vector<Trial> played{};  // of consecutive seeds from the first
};

struct ExperimentResult {
  std::vector<CellResult> cells{};  // by cell
};

// Plays what the log does not hold yet. The levels of all ladders are played side by side, so that a budget
// that runs out leaves all about as far. Rethrows what a trial throws, of several the first in the order of
// seeds; finished trials stay in the log.
[[nodiscard]] ExperimentResult play_experiment(const Experiment& experiment,
                                               const ExperimentOptions& options);

// The largest number of trials with an event, of all of a cell's seeds, with which the cell goes on.
[[nodiscard]] std::size_t max_events(const Metric& metric, std::size_t seeds);

// Whether a cell ends after the trials that it has played, and why. The engine asks after whole batches only,
// and with fewer trials than seeds. A cell does not end if the time is over.
[[nodiscard]] std::optional<Stop> early_stop(const Experiment& experiment, const CellResult& cell);

// The values of a metric, by its place, in the trials that have one.
[[nodiscard]] std::vector<double> values_of(const CellResult& cell, std::size_t metric);

}  // namespace koboshi::lab
