#pragma once

#include <ode/ode.h>

#include <array>
#include <span>

#include "sim_board/engine/ode/library.h"

namespace koboshi::sim_board {

// Axis-aligned bounds of a shape in the world: min x, max x, min y, ... in m.
using Bounds = std::array<dReal, 6>;

Bounds bounds_of(dGeomID geom);

// Returns whether the shapes with these bounds are farther apart than `reach_m`. If not, they may still be.
inline bool apart_by(const Bounds& a, const Bounds& b, double reach_m) {
  for (std::size_t i = 0; i < 6; i += 2)
    if (a[i] > b[i + 1] + reach_m || b[i] > a[i + 1] + reach_m) return true;
  return false;
}

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
  // their number, at most points.size(). Normals point from `other` into `box`. `may_touch`: the boxes'
  // bounds overlap; if they are apart by more than the reach, there are no contacts and no reason to call
  // this.
  std::size_t find(dGeomID box, dGeomID other, bool may_touch, double reach_m,
                   std::span<dContactGeom> points);

 private:
  std::size_t find_gaps(dGeomID box, dGeomID other, double reach_m, std::size_t touching,
                        std::span<dContactGeom> points);

  OdeGeom probe_;  // the moved box
};

}  // namespace koboshi::sim_board
