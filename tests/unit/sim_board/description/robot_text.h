#pragma once

#include <string>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// Every value of a description as a text, to compare two robots. The name of the file is left out.
std::string robot_text(const RobotDescription& robot);

}  // namespace koboshi::sim_board
