#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

namespace koboshi::tools {

// A whole turn in the unit that a recorded quantity has, or with which the name of its column ends: "rad",
// "true_yaw_rad", "deg". 0 for what is not an angle.
inline double turn_of(std::string_view unit) {
  if (unit == "rad" || unit.ends_with("_rad")) return 2.0 * std::numbers::pi;
  if (unit == "deg" || unit.ends_with("_deg")) return 360.0;
  return 0.0;
}

// The value of an angle after `last`, without the jump of a whole turn at the end of its range: `value` and
// the multiple of `turn` that leads nearest to `last`. Steps of a quarter turn and more are no such jumps,
// and stay as they are. NaN as `last`: none is known.
inline double unwrapped(double last, double value, double turn) {
  const double continued = value + turn * std::round((last - value) / turn);
  return std::abs(continued - last) < 0.25 * turn ? continued : value;
}

}  // namespace koboshi::tools
