#pragma once

#include <string>

#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// Duration, commands and pushes of a scenario as they stand in its file; read again they are the same to the
// microsecond, and pushes to the bit.
std::string events_text(const Scenario& scenario);

// A scenario file that repeats a run from the folder in which it will stand: the scenario's document, with
// duration, commands and pushes as the scenario has them, and without an operator.
std::string played_text(const Scenario& played, const std::filesystem::path& folder);

}  // namespace koboshi::sim
