#pragma once

#include <string>

#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// Duration, commands and pushes of a scenario as they stand in its file; read again they are the same to the
// microsecond, and pushes to the bit.
std::string events_text(const Scenario& scenario);

}  // namespace koboshi::sim
