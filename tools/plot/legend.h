#pragma once

#include <string>

#include "tools/plot/figure.h"

namespace koboshi::tools {

// The legend of all figures: the role of a curve decides its colour and its line style.
//
//   dashed orange   planned: target, plan, commanded pose
//   solid blue      measured: by the robot's sensors, or estimated
//   solid black     true: the state of the simulation, which the firmware does not know
//   dashed grey     theory: a bound, an ideal model or an analytical solution
//   green, purple   left and right in one panel; dashed if planned
//   light blue, yellow, grey   further quantities of a panel, in this order
enum class Role { kPlanned, kMeasured, kTrue, kTheory, kLeft, kRight, kFirst, kSecond, kThird };

// Indices of the palette, see palette_colour().
int colour_of(Role role);
LineStyle style_of(Role role);

// A curve of this role from a column of the data. `factor` is as in Series.
Series series(Role role, const std::string& column, const std::string& label, double factor = 1.0);
// The planned and the true course of one side.
Series planned_series(Role side, const std::string& column, const std::string& label, double factor = 1.0);

}  // namespace koboshi::tools
