#pragma once

#include <cstdint>
#include <numbers>

namespace koboshi::sim_board {

// Positions on the bus and in a drive's loops are finer than any encoder here: 2^-20 turn.
inline constexpr int kPositionBits = 20;
inline constexpr double kRadPerPositionUnit = 2.0 * std::numbers::pi / (1 << kPositionBits);

// The nearest integer, halves away from zero, as std::lround, which compilers do not inline. The value must
// lie within 63 bits.
inline std::int64_t nearest(double value) {
  const auto whole = static_cast<std::int64_t>(value);
  const double rest = value - static_cast<double>(whole);  // exact
  return whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0);
}

}  // namespace koboshi::sim_board
