#pragma once

#include <string>

#include "tools/lab/plot/figure.h"

namespace koboshi::tools {

// The legend of all figures: what a curve stands for decides its colour and its line style, here and nowhere
// else. A reader who has learned one figure can read them all.
//
//   dashed orange   planned: what was asked for (target, plan, commanded pose)
//   solid blue      measured: what the robot's sensors or its estimate say
//   solid black     true: the state of the simulation, which the firmware does not know
//   dashed grey     theory: a bound, an ideal model or an analytical solution
//   green, purple   left and right, where both stand in one panel; dashed where planned
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
