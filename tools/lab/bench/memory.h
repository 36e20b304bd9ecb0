#pragma once

#include "sim_board/scenario/scenario.h"

namespace koboshi::tools {

// What one more world of this scenario takes, with its board and firmware, in resident memory: the growth of
// a process of its own that has one and makes more, each advanced for the scenario's duration. Call it while
// this process has a single thread. Throws std::runtime_error when the process cannot be made or fails.
double memory_of_world_bytes(const sim::Scenario& scenario);

}  // namespace koboshi::tools
