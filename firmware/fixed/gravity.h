#pragma once

#include "firmware/fixed/literals.h"

namespace koboshi::fixed {

// Standard gravity g (CGPM 1901; ISO 80000-3), as the simulated world has it. The real one differs by up to
// 0.3 % from place to place, less than any bound that uses it.
inline constexpr Acceleration kGravity = literals::literal<Acceleration>(9.80665L);
// 1 / g in s^2/m: a height times this is the T_c^2 of a pendulum, in s^2 and as a ratio; a specific force
// times this is in units of g.
inline constexpr Ratio kInverseGravity = literals::literal<Ratio>(1.0L / 9.80665L);

}  // namespace koboshi::fixed
