#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "sim_board/engine/common/friction.h"
#include "sim_board/engine/common/normal_row.h"

namespace koboshi::sim_board {

// A contact for the solvers: ODE's description of its point and surface, and its friction.
struct Touch {
  dContact contact;
  dBodyID body;
  dBodyID other_body;   // null: the ground
  int ordinal;          // among the contacts of the two links
  Eigen::Vector3d v_W;  // relative velocity at the point before the step
  NormalRow normal;     // replaces ODE's, which has no restitution of soft surfaces and no gap
  FrictionLaw friction;
  std::array<Eigen::Vector3d, 2> axes_W;  // directions of friction
  FrictionGuess guess{};                  // of the present solution; forces
  // Rows of the tree's solver; none if a held sole replaces the contact.
  std::size_t first_row = 0;
  std::size_t rows = 0;

  bool slips() const { return (contact.surface.mode & dContactSlip1) != 0; }
  bool has_friction() const { return friction.mu > 0.0; }
  // Mass of the body at the point, which friction_error() and better_guess() need.
  double mass_kg() const;
  // Relative velocity at the point after ODE has moved the bodies for `step_s`.
  Eigen::Vector3d velocity_after(double step_s) const;
  // Returns the solution in the contact plane, from the force on the body and the velocity at the point.
  FrictionSolution solution(const Eigen::Vector3d& f_W, const Eigen::Vector3d& v_W) const;
};

FrictionLaw friction_law(const dSurfaceParameters& surface);
// Directions of friction in the contact plane. If the surface has none, ODE chooses them.
std::array<Eigen::Vector3d, 2> friction_axes(const dContact& contact);

// The contact with its guess of friction, for ODE's contact joint. `target_m_per_s` is that of its normal
// row.
dContact ode_contact(const Touch& touch, double target_m_per_s);

}  // namespace koboshi::sim_board
