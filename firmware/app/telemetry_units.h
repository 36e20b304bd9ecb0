#pragma once

#include <cstdint>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/fixed/units.h"
#include "firmware/robot/geometry.h"

namespace koboshi::app {

// Convert quantities to the 16 bits of the object dictionary: rounded, and saturated.

constexpr std::int16_t narrow_raw(std::int32_t raw, int shift) {
  return fixed::saturate<std::int16_t>(fixed::shift_rounded(raw, shift));
}
constexpr std::int16_t narrow(fixed::Angle angle) { return narrow_raw(angle.raw(), 16); }      // 2^-16 turn
constexpr std::int16_t narrow(fixed::AngularRate rate) { return narrow_raw(rate.raw(), 12); }  // 2^-12 turn/s
constexpr std::int16_t narrow(fixed::Acceleration a) { return narrow_raw(a.raw(), 12); }       // 2^-8 m/s^2
constexpr std::int16_t narrow(fixed::Length length) { return narrow_raw(length.raw(), 9); }    // 2^-15 m
// Converts to thousandths of the quantity's unit: mm, mm/s.
template <fixed::AnyQuantity Q>
constexpr std::int16_t thousandths(Q quantity) {
  return fixed::saturate<std::int16_t>(
      fixed::shift_rounded(std::int64_t{quantity.raw()} * 1'000, Q::kFractionBits));
}

// Converts the three components of a vector.
template <typename Q>
constexpr void narrow(const robot::Vector<Q>& vector, std::int16_t (&shown)[3]) {
  shown[0] = narrow(vector.x);
  shown[1] = narrow(vector.y);
  shown[2] = narrow(vector.z);
}

}  // namespace koboshi::app
