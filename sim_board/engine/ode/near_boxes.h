#pragma once

#include <ode/ode.h>

#include <span>

#include "sim_board/engine/ode/library.h"

namespace koboshi::sim_board {

// Contacts of two boxes, and points at which they are about to touch.
//
// ODE finds contacts of boxes that overlap. For boxes that do not, or only elsewhere, one of them is moved
// towards the other by the reach, along the axis that separates them most (or along the normal of their
// contact), and ODE finds the contacts of the moved box. Their depth there, less what they gained by the
// move, is their depth here: negative, the gap.
class NearBoxes {
 public:
  NearBoxes() : probe_(dCreateBox(nullptr, 1.0, 1.0, 1.0)) {}

  // Writes the contacts of two boxes, the touching ones first, then those with a gap below `reach_m`. Returns
  // their number, at most points.size(). Normals point from `other` into `box`.
  std::size_t find(dGeomID box, dGeomID other, double reach_m, std::span<dContactGeom> points);

 private:
  std::size_t find_gaps(dGeomID box, dGeomID other, double reach_m, std::size_t touching,
                        std::span<dContactGeom> points);

  OdeGeom probe_;  // the moved box
};

}  // namespace koboshi::sim_board
