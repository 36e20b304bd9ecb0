#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// The linear inverted pendulum of the walk, and a rigid link that tips over.
[[nodiscard]] Validation inverted_pendulum();

// How far the mass on a massless leg is off after three time constants, m.
[[nodiscard]] double inverted_pendulum_error_m(const ValidationSetup& setup);

}  // namespace koboshi::tools
