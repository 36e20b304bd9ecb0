#pragma once

#include <memory>

#include "sim_board/robot/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// Returns whether this program was built with MuJoCo. Without it, Stepper::kMujoco is not available.
[[nodiscard]] bool has_mujoco();

// Creates a world with the robot at rest in the engine of options.stepper. Throws std::invalid_argument for
// an invalid description or options.
std::unique_ptr<World> make_world(const RobotDescription& robot, const WorldOptions& options);

}  // namespace koboshi::sim
