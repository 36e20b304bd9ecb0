#pragma once

#include "sim_board/scenario/scenario.h"
#include "tools/experiment/experiment.h"
#include "tools/run/simulation.h"

namespace koboshi::tools {

// Plays a scenario in this process, without leaving files, to its end or until the robot has fallen. The
// values are the numbers and truths of summary.json, and `failed`, 1 where the run ended with an error, such
// as a world that blew up; that counts as a fall. May be called from several threads at a time. Throws
// sim::InputError.
[[nodiscard]] Values play_scenario(const sim::Scenario& scenario, const RobotChange& change);

}  // namespace koboshi::tools
