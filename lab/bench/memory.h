#pragma once

#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// Resident memory of one more world of this scenario, with its board and firmware: the growth of a child
// process that has one world and makes more, each advanced for the scenario's duration. Call it while this
// process has a single thread. Throws std::runtime_error when the process cannot be made or fails.
double memory_of_world_bytes(const simulation::Scenario& scenario);

}  // namespace koboshi::lab
