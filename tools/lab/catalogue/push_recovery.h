#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"
#include "tools/lab/plot/plane_figure.h"

namespace koboshi::tools {

// How large a push against the trunk the robot survives, standing and walking in place, from all sides: a
// half sine of 0.1 s at the trunk's centre of mass. In each seed's world and direction the largest impulse is
// found by bisection, which takes it that what survives a push survives a weaker one. What 95 of 100 seeds
// survive is the 5th percentile of that.

// A reaction of the firmware that can be switched off.
struct Feedback {
  std::string name;                     // "capture"
  std::vector<std::string> parameters;  // of the controller, which are zero then
};
[[nodiscard]] const std::vector<Feedback>& feedbacks();

// What a robot does that is pushed: "standing", or "walking" on the spot.
[[nodiscard]] const std::vector<std::string>& pushed_states();

struct PushRecoveryOptions : CommandedWalkOptions {
  std::vector<std::string> states = pushed_states();
  std::vector<std::string> ablate{};  // feedbacks that are switched off, one at a time, beside all on
  std::size_t directions = 16;
  double highest_N_s_per_kg = 0.8;  // of which all impulses are less
  int halvings = 6;
  std::size_t phase_bins = 4;  // of a cycle of two steps
};

// The largest of `halvings` bisections of 0 .. highest that is survived; 0 where none is.
[[nodiscard]] double largest_survived(double highest, int halvings,
                                      const std::function<bool(double)>& survives);

// A cell for each state, feedback that is off and direction. Throws sim::InputError.
[[nodiscard]] Experiment make_push_recovery(const PushRecoveryOptions& options);

// What is survived from a direction by 95 of 100 seeds; walking, in the phase in which that is least.
struct SurvivedPush {
  std::string state;    // "standing", "walking"
  std::string without;  // the feedback that is off; "nothing"
  double direction_rad = 0.0;
  QuantileEstimate impulse_N_s_per_kg;
  // How the weakest push ended that was not survived, over the seeds: by the names of outcome_measures().
  std::map<std::string, std::size_t> losses{};
};
[[nodiscard]] std::vector<SurvivedPush> survived_pushes(const PushRecoveryOptions& options,
                                                        const Experiment& experiment,
                                                        const ExperimentResult& result);

// standing_min_Ns_per_kg, walking_min_Ns_per_kg, the same without each feedback, and all directions.
[[nodiscard]] Conclusions push_recovery_conclusions(const std::vector<SurvivedPush>& pushes);

// What is survived over the direction in which the robot is pushed, forward upwards.
[[nodiscard]] PlaneFigure polar_figure(const std::vector<SurvivedPush>& pushes);

}  // namespace koboshi::tools
