#pragma once

#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"

namespace koboshi::tools {

// A long time of random commands and pushes of any size: nothing may end it but the clock. After a fall that
// the robot does not get up from, and after a fault, nobody helps it.
struct MarathonOptions : CommandedWalkOptions {
  double hours = 1.0;
  double highest_N_s_per_kg = 0.6;  // of the pushes, one in 5 to 30 s
};

// One cell. Throws sim::InputError.
[[nodiscard]] Experiment make_marathon(const MarathonOptions& options);

// stands_at_the_end, falls, stand_ups, faults, distance_m.
[[nodiscard]] Conclusions marathon_conclusions(const Experiment& experiment, const ExperimentResult& result);

}  // namespace koboshi::tools
