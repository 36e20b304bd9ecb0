#pragma once

#include <numbers>

namespace koboshi {

// The program computes in rad and m; files and output for users have degrees and millimetres.
inline constexpr double kRadPerDegree = std::numbers::pi / 180.0;
inline constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;
inline constexpr double kMmPerM = 1000.0;

}  // namespace koboshi
