#pragma once

#include <cstddef>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// Consecutive hinges that intersect in one point and connect the same two bodies, such as the three of a hip
// or the two of an ankle. The links between them have no body of ODE: their poses follow from those of the
// first and the last link, and the tree's solver has their inertia where they are (TreeStep). Only in a step
// that ODE solves, because the tree's solver found no solution, are those before the cut carried by the
// chain's first link, those after it by its last.
struct HingeChain {
  std::vector<int> joints;  // from the parent side to the child side; at most three
  std::size_t cut = 0;      // joints[cut] separates the links carried by the first link from those carried by
                            // the last
};

// Returns one chain for each hinge.
std::vector<HingeChain> single_hinges(const mechanics::HingeTree& tree);

// Merges as many hinges as possible. Conditions: their anchors coincide; each axis is perpendicular to the
// next (for three hinges, all are mutually perpendicular at joint angles zero, and the middle one turns at
// most a quarter turn); the links between have neither collision boxes nor sensors.
//
// A carried link keeps its relative pose at joint angle zero. When the hinge at distance r is at q, its
// centre of mass is therefore misplaced by 2 r sin(q/2). The cut minimises the sum of mass times r times the
// hinge's range.
std::vector<HingeChain> lumped_hinges(const RobotDescription& robot, const mechanics::HingeTree& tree);

}  // namespace koboshi::sim_board
