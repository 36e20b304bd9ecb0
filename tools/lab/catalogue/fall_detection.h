#pragma once

#include <vector>

#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"

namespace koboshi::tools {

// How long before the first link other than a foot touches the ground the firmware foresees a fall, by its
// cause; how hard trunk or head come down, with what it does about it and without; and how often it sees a
// fall that would have been none.
struct FallDetectionOptions : CommandedWalkOptions {
  // About what is survived standing and walking: falls come from 1.2 to 2 times as much.
  double standing_N_s_per_kg = 0.45;
  double walking_N_s_per_kg = 0.32;
  // Pushes of the walk that is to be no false alarm are weaker, one in 1.5 to 4 s.
  double survivable_N_s_per_kg = 0.16;
  double walk_s = 60.0;          // for false alarms, of each seed
  std::vector<double> scales{};  // of the thresholds, besides 1, for a ROC
};

// A cell for each cause, and for walks; of pushes also one in which falls are not looked for. Throws
// sim::InputError.
[[nodiscard]] Experiment make_fall_detection(const FallDetectionOptions& options);

// lead_mean_s, lead_p05_s, the same by direction, false_alarms_per_10_min, impact_ratio, roc.
[[nodiscard]] Conclusions fall_detection_conclusions(const FallDetectionOptions& options,
                                                     const Experiment& experiment,
                                                     const ExperimentResult& result);

}  // namespace koboshi::tools
