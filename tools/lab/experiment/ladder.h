#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/experiment/experiment.h"
#include "tools/lab/plot/plane_figure.h"

namespace koboshi::tools {

// Something that is made harder, level by level, until more than 5 of 100 seeds fail.
struct Ladder {
  std::string name;
  std::string unit;                // of the levels
  std::vector<std::size_t> cells;  // of the experiment, the easiest first
};

inline constexpr double kMostFailures = 0.05;  // for Measure::most_share of what counts as a failure

// How far one came.
struct Climb {
  std::size_t first = 0;               // of its cells in ClimbResult
  std::size_t levels = 0;              // that were played
  std::optional<std::size_t> highest;  // the last cell before the first that failed
  Stop stop = Stop::kAllSeeds;         // kTooMany: the next level failed; kAllSeeds: there is no next one
};

// The experiment with the cells that were played, in the order of the ladders.
struct ClimbResult {
  Experiment experiment{};
  ExperimentResult result{};
  std::vector<Climb> climbs{};  // by ladder
};

// Plays the levels of all ladders side by side, so that a budget that runs out leaves all about as far. On
// each, levels beyond the first that fails are left out.
[[nodiscard]] ClimbResult climb(const Experiment& experiment, const std::vector<Ladder>& ladders,
                                const ExperimentOptions& options);

// The number that a cell's last setting is.
[[nodiscard]] double level_of(const Cell& cell);
// How far one came, as a line for readers.
[[nodiscard]] std::string climb_line(const Ladder& ladder, const Climb& climb, const ClimbResult& result);

// Which share failed on each level, over the level as a share of the ladder's hardest. `experiment` is what
// was climbed.
[[nodiscard]] PlaneFigure ladder_figure(const std::string& title, const Experiment& experiment,
                                        const std::vector<Ladder>& ladders, const ClimbResult& result);

}  // namespace koboshi::tools
