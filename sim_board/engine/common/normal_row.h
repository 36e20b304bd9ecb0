#pragma once

#include <optional>

#include "sim_board/world/surface_contact.h"

namespace koboshi::sim_board {

// Row of a contact point's normal in one step: the speed v' at which the surfaces separate at its end, and
// the force f between them, satisfy
//   v' + force_mixing f >= target,  f >= 0,  one of the two with equality.
struct NormalRow {
  double target_m_per_s = 0.0;
  double force_mixing = 0.0;  // CFM, m/(N s)
  bool is_impact = false;     // with restitution
};

// CFM of an impact with restitution, in which the spring and damper of the surfaces take no part: with their
// CFM, a body of mass m on n points would leave with (e - c)/(1 + c) instead of e, c = CFM m/(n h).
inline constexpr double kImpactForceMixing = 1e-9;

// A point within this many times the way that its boxes move in a step has a row, although the surfaces do
// not touch yet. More than one, because an impact of one point accelerates the others towards the ground: a
// foot that lands on its heel turns about it, and its toe becomes some times faster within the same step.
inline constexpr double kReach_steps = 3.0;

// Returns the row of a point of penetration `depth_m`, negative if the surfaces are apart, that approach each
// other at `approach_m_per_s` before the step of h; nothing if the point exerts no force in this step.
//
// Spring and damper. A touching point has ERP depth/h as its target (softness()). Surfaces that are apart by
// a gap may close it but not overlap: the target is -gap/h. The damper thus acts for the share of the step in
// which they touch. Without this row they would overlap by up to the way of a step, which is no compression
// of a spring, and which its release would turn into a rebound of up to ERP times the speed of the impact.
//
// Restitution (Newton's law). Surfaces that meet faster than the threshold leave with e times the speed of
// approach. They meet in the step whose middle is nearest to the contact (J. J. Moreau, "Unilateral contact
// and dry friction in finite freedom dynamics", 1988, evaluates the gap at the middle of a step), so that an
// impact is at most half a step early or late. A point that has been deeper than the way of a step is no
// impact, but a spring that is compressed further. A bouncing surface that leaves or does not arrive within
// this step must not stop what other points' impacts do to it: its own impact follows.
// Where friction turns the slip of an eccentric impact round, Newton's law may add energy (T. R. Kane, "A
// dynamics puzzle", 1984); the engines then lower e for that step (ImpactSearch).
inline std::optional<NormalRow> normal_row(const SurfaceContact& surface, double depth_m,
                                           double approach_m_per_s, double step_s) {
  const double way_m = step_s * approach_m_per_s;
  if (surface.bounce > 0.0) {
    const bool is_fast = approach_m_per_s > surface.bounce_threshold_m_per_s;
    if (is_fast && depth_m <= way_m) {
      if (depth_m + 0.5 * way_m < 0.0) return std::nullopt;
      return NormalRow{surface.bounce * approach_m_per_s, kImpactForceMixing, true};
    }
    const bool leaves = -approach_m_per_s > surface.bounce_threshold_m_per_s && depth_m <= -way_m;
    if (leaves || depth_m + way_m < 0.0) return std::nullopt;
  }
  const double share = depth_m > 0.0 ? surface.softness.error_reduction : 1.0;
  return NormalRow{share * depth_m / step_s, surface.softness.constraint_force_mixing};
}

}  // namespace koboshi::sim_board
