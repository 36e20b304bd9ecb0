#pragma once

#include <cstddef>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/world/link_tree.h"

namespace koboshi::sim {

// Hinges in a row that meet in one point and turn the same two bodies against each other: a hip's three, an
// ankle's two. The links between the hinges have no body of their own; those before the cut ride on the
// chain's first link, those behind it on its last.
struct HingeChain {
  std::vector<int> joints;  // from the parent side to the child side; at most three
  std::size_t cut = 0;      // joints[cut] has the first link's body on its parent side, the last one's behind
};

// Every hinge by itself.
std::vector<HingeChain> single_hinges(const LinkTree& tree);

// As many hinges as can be are put together: their anchors coincide, each axis is perpendicular to the next
// (of three, all to each other at joint zero, and the middle one turns by a quarter turn at most), and the
// links between have neither boxes to collide nor sensors.
//
// A link that rides on another keeps the place that it has at joint zero, so its centre of mass is off by
// 2 r sin(q/2) when the hinge between them is at q, r from the axis. The cut is where the sum of mass times r
// times the hinge's range is least.
std::vector<HingeChain> lumped_hinges(const RobotDescription& robot, const LinkTree& tree);

}  // namespace koboshi::sim
