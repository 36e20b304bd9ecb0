#pragma once

#include <memory>

#include "sim_board/description/description.h"
#include "sim_board/engine/mujoco/has_mujoco.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Creates a world with the robot at rest in the engine of options.stepper. Throws std::invalid_argument for
// an invalid description or options.
std::unique_ptr<World> make_world(const RobotDescription& robot, const WorldOptions& options);

}  // namespace koboshi::sim_board
