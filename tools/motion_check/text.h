#pragma once

#include <string>

#include "tools/motion_check/check.h"

namespace koboshi::tools {

// The report as lines for a terminal: the findings, with `steps` a table of the steps, and the verdict.
[[nodiscard]] std::string report_text(const MotionReport& report, const MotionChecker& checker, bool steps);

// The report as a JSON object, for editors and CI (docs/reference/motion-check.md).
[[nodiscard]] std::string report_json(const MotionReport& report, const MotionChecker& checker);

}  // namespace koboshi::tools
