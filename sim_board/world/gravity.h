#pragma once

namespace koboshi::sim_board {

// Standard gravity (CGPM 1901; ISO 80000-3), along -z of the world. The firmware has its own constant in
// firmware/fixed/gravity.h; a test of simulation/gait checks that the two are equal.
inline constexpr double kGravity_m_per_s2 = 9.80665;

}  // namespace koboshi::sim_board
