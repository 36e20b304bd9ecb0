#pragma once

#include "firmware/fixed/quantity.h"

namespace koboshi::fixed {

// Returns the part of `value` outside the band from -half_width to +half_width, zero inside; continuous at
// the band's edges and odd in `value`. `half_width` is zero (no band) or positive, in the unit of `value`.
template <AnyQuantity Q>
[[nodiscard]] constexpr Q dead_band(Q value, Q half_width) noexcept {
  if (value > half_width) return value - half_width;
  return value < -half_width ? value + half_width : Q();
}

}  // namespace koboshi::fixed
