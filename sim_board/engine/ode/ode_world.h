#pragma once

#include <memory>

#include "sim_board/description/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Creates an ODE world with the robot at rest. Throws std::invalid_argument for an invalid description or
// options.
std::unique_ptr<World> make_ode_world(const RobotDescription& robot, const WorldOptions& options);

}  // namespace koboshi::sim_board
