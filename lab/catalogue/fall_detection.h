#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// How long before the first link other than a foot touches the ground the firmware predicts a fall, by its
// cause; how hard trunk or head come down, with the protective motion and without; and how often it predicts
// a fall in a walk that would not have fallen.
struct FallDetectionOptions : ExperimentSetup {
  // About what the robot survives standing and walking: falls come from 1.2 to 2 times as much.
  double standing_N_s_per_kg = 0.45;
  double walking_N_s_per_kg = 0.32;
  // Pushes of the walks without falls are weaker, one in 1.5 to 4 s.
  double survivable_N_s_per_kg = 0.16;
  double walk_s = 60.0;          // duration of these walks, of each seed
  std::vector<double> scales{};  // of the thresholds, besides 1, for a ROC
};

struct FallTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  bool fell = false;
  std::optional<bool> missed{};            // the fall touched the ground before it was predicted
  std::optional<bool> false_alarm{};       // of a walk: a fall was predicted that would not have happened
  std::optional<double> lead_s{};          // from the prediction to the contact with the ground
  std::optional<double> impact_m_per_s{};  // of trunk or head
  std::optional<double> walked_s{};        // of a walk
  std::optional<bool> side{};              // the trunk leant more to a side than forward or backward
};
[[nodiscard]] const FieldTable<FallTrial>& fall_fields();

// A cell for each cause, and for walks; of some causes also one without fall detection. It concludes
// lead_mean_s, lead_p05_s, the same by direction, false_alarms_per_10_min, impact_ratio_CAUSE and roc. Throws
// InputError.
[[nodiscard]] Experiment make_fall_detection(const FallDetectionOptions& options);

}  // namespace koboshi::lab
