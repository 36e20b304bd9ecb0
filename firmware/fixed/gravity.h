#pragma once

#include "firmware/fixed/literals.h"

namespace koboshi::fixed {

// 1 / g in s^2/m, for standard gravity g = 9.80665 m/s^2 (CGPM 1901; ISO 80000-3), as the simulated world has
// it: a height times this is the T_c^2 of a pendulum, in s^2 and as a ratio.
inline constexpr Ratio kInverseGravity = literals::literal<Ratio>(1.0L / 9.80665L);

// Gravity as the estimation of attitude and ZMP has it, and its inverse. It differs from standard gravity by
// 0.03 per cent, less than gravity does from place to place (0.3 per cent). It stays, since another value
// would change the last bits of every trajectory, and so of every experiment in docs/experiment.
inline constexpr Acceleration kRoundedGravity = literals::literal<Acceleration>(9.81L);
inline constexpr Ratio kInverseRoundedGravity = literals::literal<Ratio>(0.101936799L);

}  // namespace koboshi::fixed
