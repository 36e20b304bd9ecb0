#pragma once

#include "tools/motion_check/check.h"
#include "view/recording/recording.h"

namespace koboshi::tools {

// Returns a recording of the last checked motion without physics: the robot has the angles of its targets and
// stands on the soles that carry. It shows ZMP, centre of mass, support polygon, and the findings as events,
// with the overlays of `koboshi render`.
[[nodiscard]] view::Recording preview_recording(const MotionReport& report, const MotionChecker& checker);

}  // namespace koboshi::tools
