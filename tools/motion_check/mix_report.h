#pragma once

#include <vector>

#include "tools/motion_check/mix_extremes.h"
#include "tools/motion_check/report.h"

namespace koboshi::tools {

// Judges what the mixes of a path may do: adds a warning for each joint that they may turn beyond its limit
// (C012), for each pair of links that overlap only with the corrections at their bounds (C020), and for each
// step in which the centre of mass then leaves the support polygon (C021). Such a step makes a stable path
// close: nothing is known of the sensors. `report` has the verdict without corrections.
void judge_mixes(const Trajectory& trajectory, const std::vector<TickState>& states,
                 const std::vector<MixExtreme>& extremes, const sim_board::RobotDescription& robot,
                 const CheckLimits& limits, PathReport& report);

}  // namespace koboshi::tools
