#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// A physical pendulum and a double one: periods, motion and energy.
[[nodiscard]] Validation pendulum_swing();

// How far the angle of a pendulum let go at 1.5 rad is off after a second, rad.
[[nodiscard]] double pendulum_error_rad(const ValidationSetup& setup);

}  // namespace koboshi::tools
