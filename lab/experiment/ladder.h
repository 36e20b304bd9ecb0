#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "lab/experiment/experiment.h"
#include "tools/plot/plane_figure.h"

namespace koboshi::lab {

// A ladder ends at the first level that more than 5 of 100 seeds fail.
inline constexpr double kMaxFailureShare = 0.05;  // for Metric::max_share of a failure

// Whether a cell's trials are finished without too many failures.
[[nodiscard]] bool is_passed(const CellResult& cell);

struct Climb {
  std::optional<std::size_t> highest;  // the last cell before the first that failed
  Stop stop = Stop::kAllSeeds;         // kTooMany: the next level failed; kAllSeeds: there is no next one
};
[[nodiscard]] Climb climb_of(const Ladder& ladder, const ExperimentResult& result);

// The highest level and why the ladder ended there, as a line for readers.
[[nodiscard]] std::string climb_line(const Experiment& experiment, const Ladder& ladder, const Climb& climb);

// The number that a cell's last setting is.
[[nodiscard]] double level_of(const Cell& cell);

// The share that failed on each level, over the level as a share of the ladder's hardest.
[[nodiscard]] tools::PlaneFigure ladder_figure(const std::string& title, const Experiment& experiment,
                                               const ExperimentResult& result);

}  // namespace koboshi::lab
