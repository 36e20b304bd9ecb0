#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// A box on an inclined plane sticks, or slides.
[[nodiscard]] Validation slope();

}  // namespace koboshi::tools
