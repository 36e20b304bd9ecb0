#pragma once

#include <cstdint>

#include "firmware/fixed/units.h"

namespace koboshi::fixed {

// elapsed / duration as a ratio, clamped to 0..1, rounded to nearest. A duration of zero or less is over: 1.
// One division; the interpolations below have none, so a tick computes it once for all joints.
[[nodiscard]] constexpr Ratio elapsed_fraction(std::int32_t elapsed_us, std::int32_t duration_us) {
  if (elapsed_us >= duration_us) return kOne;
  if (elapsed_us <= 0) return Ratio();
  return mul_div(kOne, elapsed_us, duration_us);
}

// from + (to - from) * fraction, for 0 <= fraction <= 1; exact at both ends, else within one LSB. Linear in
// the representation, also for angles: a joint that goes from -170 to 170 degrees passes 0, because its stops
// do not let it pass 180.
template <AnyQuantity Q>
[[nodiscard]] constexpr Q interpolate(Q from, Q to, Ratio fraction) {
  const std::int64_t difference = std::int64_t{to.raw()} - from.raw();
  // Lies between the two, so it fits.
  return Q::from_raw(static_cast<std::int32_t>(
      from.raw() + shift_rounded(difference * fraction.raw(), Ratio::kFractionBits)));
}

// The same the short way round: a heading that goes from -170 to 170 degrees passes 180.
[[nodiscard]] constexpr Angle interpolate_heading(Angle from, Angle to, Ratio fraction) {
  return from + product<Angle>(to - from, fraction);
}

// How far a shaft turns at `rate` in `elapsed_us`, |elapsed_us| <= 2^28 (4 minutes); wraps. Rounded to
// nearest.
[[nodiscard]] constexpr Angle rotation(AngularRate rate, std::int32_t elapsed_us) {
  static_assert(Angle::kFractionBits - AngularRate::kFractionBits == 8);  // 2^8 / 10^6 = 4 / 15625
  return Angle::from_wide_raw(divide_rounded(std::int64_t{rate.raw()} * elapsed_us * 4, 15625));
}

}  // namespace koboshi::fixed
