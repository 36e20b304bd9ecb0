#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// The ZMP of the whole robot in squats: by sensors, by contact forces, by the motion of all links.
[[nodiscard]] Validation zmp_comparison();

}  // namespace koboshi::tools
