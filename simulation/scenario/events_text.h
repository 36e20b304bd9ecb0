#pragma once

#include <string>

#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Returns duration, commands and pushes in the format of a scenario file. Reading them back gives the same
// times to the microsecond and the same pushes to the bit.
std::string events_text(const Scenario& scenario);

// Returns a scenario file that repeats a run when placed in `folder`: the scenario's document with duration,
// commands and pushes of `played`, and without an operator.
std::string played_text(const Scenario& played, const std::filesystem::path& folder);

}  // namespace koboshi::simulation
