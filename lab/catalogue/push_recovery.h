#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/experiment/report.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// How large a push against the trunk the robot survives, standing and walking in place, from all sides: a
// half sine of 0.1 s at the trunk's centre of mass. In each seed's world and direction the largest impulse is
// found by bisection, which assumes that a robot that survives a push survives a weaker one. The impulse that
// 95 of 100 seeds survive is the 5th percentile.

// A reaction of the firmware that can be switched off.
struct Feedback {
  std::string name;                     // "capture"
  std::vector<std::string> parameters;  // of the controller, which are zero then
};
[[nodiscard]] const std::vector<Feedback>& feedbacks();

// The activities of the pushed robot: "standing", or "walking" on the spot.
[[nodiscard]] const std::vector<std::string>& pushed_states();

struct PushRecoveryOptions : ExperimentSetup {
  std::vector<std::string> states = pushed_states();
  std::vector<std::string> ablate{};  // feedbacks that are switched off, one at a time, beside all on
  std::size_t directions = 16;
  double highest_N_s_per_kg = 0.8;  // all impulses are less
  int halvings = 6;
  std::size_t phase_bins = 4;  // of a cycle of two steps
};

struct PushTrial {
  std::string error{};
  double impulse_N_s_per_kg = 0.0;   // the largest that the robot survived
  double phase = 0.0;                // of the cycle of two steps at which it was pushed, 0..1
  std::optional<Outcome> lost_by{};  // of the weakest push that it did not survive
};
[[nodiscard]] const FieldTable<PushTrial>& push_fields();

// The largest of `halvings` bisections of 0 .. highest that is survived; 0 where none is.
[[nodiscard]] double largest_survived(double highest, int halvings,
                                      const std::function<bool(double)>& survives);

// A cell for each state, feedback that is off and direction. It concludes push_recovery_conclusions. Throws
// InputError.
[[nodiscard]] Experiment make_push_recovery(const PushRecoveryOptions& options);

// The impulse from a direction that 95 of 100 seeds survive; walking, in the phase in which it is least.
struct SurvivedPush {
  double direction_rad = 0.0;
  QuantileEstimate impulse_N_s_per_kg;
};

// A column of the table: a state, and the feedback that is off.
struct PushColumn {
  std::string state;    // "standing", "walking"
  std::string without;  // "nothing"
  std::vector<SurvivedPush> directions{};
  std::map<Outcome, std::size_t> losses{};  // PushTrial::lost_by, over directions and seeds

  std::string label() const;  // "walking without capture"
};
[[nodiscard]] std::vector<PushColumn> survived_pushes(const PushRecoveryOptions& options,
                                                      const ExperimentResult& result);

// standing_min_Ns_per_kg, walking_min_Ns_per_kg, the same without each feedback, and all directions. The
// figure shows the survived impulse over the direction of the push, forward upwards.
[[nodiscard]] Conclusions push_recovery_conclusions(const std::vector<PushColumn>& columns);

}  // namespace koboshi::lab
