#pragma once

namespace koboshi::sim_board {

// The normal force of a contact of two free surfaces: a spring whose damping grows with its compression,
//
//   F = k d (1 + lambda d' / v),
//
// with the compression d, its rate d', and the rate v at which the surfaces met (Hunt and Crossley,
// "Coefficient of restitution interpreted as damping in vibroimpact", J. Appl. Mech. 42, 1975). It begins and
// ends at zero and never pulls. With the first integral of its motion,
//
//   (1 + e) lambda = ln((1 + lambda) / (1 - lambda e)),
//
// the speeds after and before are in the ratio e, whatever the masses are: a robot's foot, whose mass at the
// contact depends on its joints, needs no mass in the law.

// Returns lambda for a coefficient of restitution, which counts as at least 0.02: less would take a longer
// contact than a step's parts resolve. Solved by bisection, to rounding.
[[nodiscard]] double bounce_damping(double restitution);

}  // namespace koboshi::sim_board
