#pragma once

#include <memory>

#include "sim_board/robot/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// Whether this program was built with MuJoCo. Without, there is no Stepper::kMujoco.
[[nodiscard]] bool has_mujoco();

// The robot at rest in the engine that options.stepper names. Throws std::invalid_argument for a description
// or options that make no world.
std::unique_ptr<World> make_world(const RobotDescription& robot, const WorldOptions& options);

}  // namespace koboshi::sim
