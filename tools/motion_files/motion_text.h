#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "base/text/user_units.h"

namespace koboshi::tools {

// Numbers as a generated motion file has them.

// To 0.001 degrees.
[[nodiscard]] inline std::string degrees(double angle_rad) {
  double rounded = std::round(1e3 * angle_rad / kRadPerDegree) / 1e3;
  if (rounded == 0.0) rounded = 0.0;  // no minus zero
  return fmt::format("{:g}", rounded);
}

[[nodiscard]] inline std::string seconds(std::int64_t time_us) {
  return fmt::format("{:g}", 1e-6 * static_cast<double>(time_us));
}

// Quoted, so that a text without quotes and backslashes is nothing else in YAML.
[[nodiscard]] inline std::string quoted(const std::string& text) { return '"' + text + '"'; }

}  // namespace koboshi::tools
