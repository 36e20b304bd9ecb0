#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// Impacts: a ball-like box that bounces on, and a rod that lands on its edge.
[[nodiscard]] Validation bounce();

}  // namespace koboshi::tools
