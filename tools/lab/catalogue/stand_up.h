#pragma once

#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"

namespace koboshi::tools {

// How the robot gets up from however it lies: dropped limp with a random attitude and random joint angles, it
// settles, and is told to get up. It has done so when it stands by itself, upright and still; the time counts
// from the command, when it lies still.
struct StandUpOptions : CommandedWalkOptions {
  double drop_m = 0.05;
  double joint_share = 0.8;  // of each joint's range, about its middle, in which its angle is drawn
};

// One cell. Throws sim::InputError.
[[nodiscard]] Experiment make_stand_up(const StandUpOptions& options);

// success_rate, first_attempt_rate, prone_median_s, supine_median_s, attempts_mean, and by how it lay.
[[nodiscard]] Conclusions stand_up_conclusions(const Experiment& experiment, const ExperimentResult& result);

}  // namespace koboshi::tools
