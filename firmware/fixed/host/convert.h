#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "firmware/fixed/units.h"

// Between quantities and double, in SI units with angles in rad. For the host only: the firmware may not
// include it.
namespace koboshi::fixed {

// One unit of Q, 2^Q::kFractionBits LSB, in SI units.
template <AnyQuantity Q>
inline constexpr double kUnitInSi =
    std::same_as<Q, Angle> || std::same_as<Q, AngularRate> ? 2.0 * std::numbers::pi : 1.0;

// Multiplied by a power of two, which is exact as std::ldexp is, without a call for each value.
template <AnyQuantity Q>
[[nodiscard]] double to_double(Q quantity) {
  constexpr double kLsb = 1.0 / static_cast<double>(std::uint64_t{1} << Q::kFractionBits);
  return quantity.raw() * kLsb * kUnitInSi<Q>;
}

// Rounded to nearest. An angle is reduced to [-pi, pi] first, and pi itself becomes Angle::max(), so that a
// joint's upper limit stays above its lower one; the other quantities saturate. Throws std::domain_error when
// `value` is not finite.
template <AnyQuantity Q>
[[nodiscard]] Q from_double(double value) {
  if (!std::isfinite(value)) throw std::domain_error("a quantity must be finite");
  double units = value / kUnitInSi<Q>;
  if constexpr (Q::kOverflow == Overflow::kWrap) units = std::remainder(units, 1.0);
  const double raw = std::round(std::ldexp(units, Q::kFractionBits));
  if (raw <= Q::min().raw()) return Q::min();
  if (raw >= Q::max().raw()) return Q::max();
  return Q::from_raw(static_cast<std::int32_t>(raw));
}

}  // namespace koboshi::fixed
