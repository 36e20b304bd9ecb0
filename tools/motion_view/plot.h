#pragma once

#include <filesystem>

#include "tools/motion_check/check.h"

namespace koboshi::tools {

// Draws the last checked motion: the angles of the joints that move most, speeds and torques as shares of
// their limits, the margins of ZMP and centre of mass with the band that is called close, and the findings as
// marks. The extension of `out` is .png or .svg. Throws InputError for another one, PlotError and
// WriteError.
void plot_motion(const MotionReport& report, const MotionChecker& checker, const std::filesystem::path& out);

}  // namespace koboshi::tools
