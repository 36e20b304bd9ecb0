#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// Dry friction of a joint: hysteresis under a spring, break-away, rest.
[[nodiscard]] Validation friction_loop();

}  // namespace koboshi::tools
