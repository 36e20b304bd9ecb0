#pragma once

#include "firmware/fixed/literals.h"

namespace koboshi::fixed {

// Standard gravity g = 9.80665 m/s^2 (CGPM 1901; ISO 80000-3), as the simulated world has it
// (sim_board/world/gravity.h), and 1 / g in s^2/m: a height times 1 / g is the T_c^2 of a pendulum.
inline constexpr Acceleration kGravity = literals::literal<Acceleration>(9.80665L);
inline constexpr Ratio kInverseGravity = literals::literal<Ratio>(1.0L / 9.80665L);

}  // namespace koboshi::fixed
