#pragma once

#include "studio/document/motion_rows.h"

namespace koboshi::studio {

// Describes a step in its row by what the text says, also for a step with errors. `default_interpolation`: of
// the file; may be nullptr.
void describe_step(const YamlNode& step, const YamlNode* default_interpolation, MotionRow& row);

}  // namespace koboshi::studio
