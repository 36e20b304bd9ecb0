#pragma once

#include <vector>

#include "tools/lab/experiment/experiment.h"

namespace koboshi::tools {

// The ways in which a trial can be lost, each 0 or 1 and at most one of them 1, in this order of precedence:
//   energy_guard  the world gained energy or left the finite, and the run ended (sim::WorldBlewUp)
//   failed        any other error ended the run
//   fell          the trunk leant beyond 60 degrees
//   low_supply    the firmware stopped for a low supply
//   gave_up       the firmware foresaw a fall, faulted or stopped in an emergency, and the robot did not fall
// `lost` is 1 if any of them is. A trial that is not lost was survived.
inline constexpr const char* kLost = "lost";

// As columns of a table; `failed`, if it ever happens, below it.
[[nodiscard]] std::vector<Measure> outcome_measures();

// Copies the outcome, with the error that ended the trial, from the values of a played scenario
// (scenario_trial.h).
void add_outcome(const Values& played, Values& values);

}  // namespace koboshi::tools
