#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// A body falls as gravity dictates.
[[nodiscard]] Validation free_fall();

// How far the position of a falling box is off after half a second, m.
[[nodiscard]] double free_fall_error_m(const ValidationSetup& setup);

}  // namespace koboshi::tools
