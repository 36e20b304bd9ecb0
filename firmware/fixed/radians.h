#pragma once

#include "firmware/fixed/literals.h"
#include "firmware/fixed/units.h"

namespace koboshi::fixed {

// Converts an angle within the ratio's range, 2 rad either way, to a ratio in rad, and back. The formats are
// two bits apart (2^32 a turn, 2^30 a rad): the factors are 2 pi / 4 and its inverse.
[[nodiscard]] constexpr Ratio in_rad(Angle angle) {
  constexpr Ratio kFactor = literals::literal<Ratio>(literals::kRadPerTurn / 4.0L);
  return product<Ratio>(Ratio::from_raw(angle.raw()), kFactor);
}
[[nodiscard]] constexpr Angle from_rad(Ratio rad) {
  constexpr Ratio kFactor = literals::literal<Ratio>(4.0L / literals::kRadPerTurn);
  return Angle::from_raw(product<Ratio>(rad, kFactor).raw());
}

}  // namespace koboshi::fixed
