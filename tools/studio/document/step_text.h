#pragma once

#include "tools/studio/document/motion_rows.h"

namespace koboshi::studio {

// Describes a step in its row by what the text says, also for a step with errors. `default_interpolation`: of
// the file; may be nullptr.
void describe_step(const sim::YamlNode& step, const sim::YamlNode* default_interpolation, MotionRow& row);

}  // namespace koboshi::studio
