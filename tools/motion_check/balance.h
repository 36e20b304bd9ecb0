#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "tools/motion_check/report.h"

namespace koboshi::tools {

// Judges the balance of a path: sets the verdict and the least margin of the report, and adds a finding for
// each step whose margin is small or that lets the robot roll onto an edge of its soles (C006 to C008).
void judge_balance(const Trajectory& trajectory, const std::vector<TickState>& states,
                   const CheckLimits& limits, PathReport& report);

// The direction of a vector in GroundAxes, in words: front, back, left or right.
[[nodiscard]] std::string_view direction_of(const Eigen::Vector2d& outward);

}  // namespace koboshi::tools
