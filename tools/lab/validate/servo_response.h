#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// A servo follows steps and sines, and its speed the line of its motor.
[[nodiscard]] Validation servo_response();

// The largest error of a servo's position in a step of half a radian, rad.
[[nodiscard]] double servo_error_rad(const ValidationSetup& setup);

}  // namespace koboshi::tools
