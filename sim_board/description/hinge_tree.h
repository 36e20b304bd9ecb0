#pragma once

#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// Returns the robot's links and joints, with the same indices; its followers are the coupled hinges. Throws
// std::invalid_argument, which names the robot, unless the joints form one tree of all links with links[0] as
// its root.
mechanics::HingeTree hinge_tree(const RobotDescription& robot);

}  // namespace koboshi::sim_board
