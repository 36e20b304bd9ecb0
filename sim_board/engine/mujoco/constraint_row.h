#pragma once

#include "sim_board/world/surface_contact.h"

namespace koboshi::sim_board {

// Parameters of a MuJoCo constraint row that is equivalent to ODE's row with an ERP and a CFM.
//
// With v the row's velocity before the step of h and v' after it, f its force and r its violation (negative
// where surfaces overlap), MuJoCo solves (documentation, "Computation", "Solver parameters")
//   (v' - v)/h + R f = -B v - K d r,   R = A (1 - d)/d
// for the impedance d and an estimate A of the row's inverse inertia at the model's reference pose, and reads
// K d_max^2 and B d_max, negative, from `solref`. ODE solves v' = -(ERP/h) r - CFM f. Both agree with
//   B = 1/h,   K d = ERP/h^2,   R = CFM/h.
// A is replaced by a constant that does not depend on the robot, so that d follows from the softness alone.
struct ConstraintRow {
  double solref_stiffness = 0.0;  // -K d^2
  double solref_damping = 0.0;    // -B d
  double impedance = 0.0;         // d; MuJoCo keeps it within 0.0001 and 0.9999
};

// Contribution of a moving body or joint to A. With 1 and a step of 1 ms, d stays within its bounds for any
// CFM from 1e-7 to 10 m/(N s), and for two moving bodies, from 2e-7: at this step, the row that couples a
// follower with its leader (kCouplingForceMixing, 1e-7) is twice as soft as ODE's.
inline constexpr double kInverseInertia = 1.0;

// Smallest R per unit of A: MuJoCo keeps d below 0.9999.
inline constexpr double kMinRegularisation = 1e-4;

// `moving` is the number of movable bodies in the row: 1 for the ground and a link, 2 for two links.
inline ConstraintRow constraint_row(const Softness& softness, int moving, double step_s) {
  const double R = softness.constraint_force_mixing / step_s;
  const double A = moving * kInverseInertia;
  const double d = A / (A + R);
  return {.solref_stiffness = -softness.error_reduction * d / (step_s * step_s),
          .solref_damping = -d / step_s,
          .impedance = d};
}

}  // namespace koboshi::sim_board
