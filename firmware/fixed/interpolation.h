#pragma once

#include <cstdint>

#include "firmware/fixed/units.h"

namespace koboshi::fixed {

// Returns elapsed / duration, clamped to 0..1 and rounded to nearest; 1 for a duration of zero or less. It
// takes the only division of an interpolation, so that a tick computes it once for all joints.
[[nodiscard]] constexpr Ratio elapsed_fraction(std::int32_t elapsed_us, std::int32_t duration_us) {
  if (elapsed_us >= duration_us) return kOne;
  if (elapsed_us <= 0) return Ratio();
  return mul_div(kOne, elapsed_us, duration_us);
}

// Returns from + (to - from) * fraction for 0 <= fraction <= 1, exact at both ends, else within one LSB.
// Angles are interpolated as numbers: a joint passes 0 on its way from -170 to 170 degrees, since its stops
// are at 180.
template <AnyQuantity Q>
[[nodiscard]] constexpr Q interpolate(Q from, Q to, Ratio fraction) {
  // The product of two numbers of 32 bits takes one instruction; few differences need 33.
  std::int32_t difference = 0;
  const bool is_wide = __builtin_sub_overflow(to.raw(), from.raw(), &difference);
  const std::int64_t product = is_wide ? (std::int64_t{to.raw()} - from.raw()) * fraction.raw()
                                       : std::int64_t{difference} * fraction.raw();
  // Lies between the two, so it fits.
  return Q::from_raw(static_cast<std::int32_t>(from.raw() + shift_rounded(product, Ratio::kFractionBits)));
}

// Likewise along the shorter arc: a heading passes 180 on its way from -170 to 170 degrees.
[[nodiscard]] constexpr Angle interpolate_heading(Angle from, Angle to, Ratio fraction) {
  return from + product<Angle>(to - from, fraction);
}

// Returns the angle that a shaft turns at `rate` in `elapsed_us`, |elapsed_us| <= 2^28 (4 minutes), rounded
// to nearest; wraps.
[[nodiscard]] constexpr Angle rotation(AngularRate rate, std::int32_t elapsed_us) {
  static_assert(Angle::kFractionBits - AngularRate::kFractionBits == 8);  // 2^8 / 10^6 = 4 / 15625
  return Angle::from_wide_raw(divide_rounded(std::int64_t{rate.raw()} * elapsed_us * 4, 15625));
}

}  // namespace koboshi::fixed
