#pragma once

#include "firmware/fixed/literals.h"
#include "firmware/fixed/units.h"

namespace koboshi::walk {

// Converts an angle within the ratio's range, 2 rad either way, to a ratio in rad, and back. The formats are
// two bits apart (2^32 a turn, 2^30 a rad): the factors are 2 pi / 4 and its inverse.
[[nodiscard]] constexpr fixed::Ratio in_rad(fixed::Angle angle) {
  constexpr fixed::Ratio kFactor =
      fixed::literals::literal<fixed::Ratio>(fixed::literals::kRadPerTurn / 4.0L);
  return fixed::product<fixed::Ratio>(fixed::Ratio::from_raw(angle.raw()), kFactor);
}
[[nodiscard]] constexpr fixed::Angle from_rad(fixed::Ratio rad) {
  constexpr fixed::Ratio kFactor =
      fixed::literals::literal<fixed::Ratio>(4.0L / fixed::literals::kRadPerTurn);
  return fixed::Angle::from_raw(fixed::product<fixed::Ratio>(rad, kFactor).raw());
}

}  // namespace koboshi::walk
