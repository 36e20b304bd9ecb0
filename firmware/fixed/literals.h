#pragma once

#include <limits>

#include "firmware/fixed/units.h"

// Literals of quantities: 90.0_deg, 1.5_rad, 0.065_m, 0.5_ratio. The compiler evaluates them, so that no
// float reaches the firmware; a value out of range does not compile. The range of an angle excludes
// +180.0_deg: Angle::max() is one LSB below.
namespace koboshi::fixed::literals {

// Makes an error of a literal out of range: it is not constexpr, and the error message names it. Defined
// nowhere.
void literal_is_out_of_range();

// Returns `value`, in units of Q, rounded to nearest.
template <AnyQuantity Q>
[[nodiscard]] consteval Q literal(long double value) {
  long double raw = value;
  for (int bit = 0; bit < Q::kFractionBits; ++bit) raw *= 2.0L;
  raw += raw < 0.0L ? -0.5L : 0.5L;
  constexpr long double kLimit = 2147483648.0L;
  if (!(raw > -kLimit - 1.0L && raw < kLimit)) literal_is_out_of_range();
  return Q::from_raw(static_cast<std::int32_t>(raw));
}

inline constexpr long double kRadPerTurn = 6.283185307179586476925286766559L;

consteval Angle operator""_deg(long double value) { return literal<Angle>(value / 360.0L); }
consteval Angle operator""_rad(long double value) { return literal<Angle>(value / kRadPerTurn); }
consteval AngularRate operator""_deg_per_s(long double value) { return literal<AngularRate>(value / 360.0L); }
consteval AngularRate operator""_rad_per_s(long double value) {
  return literal<AngularRate>(value / kRadPerTurn);
}
consteval Length operator""_m(long double value) { return literal<Length>(value); }
consteval Torque operator""_Nm(long double value) { return literal<Torque>(value); }
consteval Force operator""_N(long double value) { return literal<Force>(value); }
consteval Acceleration operator""_m_per_s2(long double value) { return literal<Acceleration>(value); }
consteval Mass operator""_kg(long double value) { return literal<Mass>(value); }
consteval Gain operator""_gain(long double value) { return literal<Gain>(value); }
consteval Ratio operator""_ratio(long double value) { return literal<Ratio>(value); }

}  // namespace koboshi::fixed::literals
