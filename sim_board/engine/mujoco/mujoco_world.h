#pragma once

#include <memory>

#include "sim_board/robot/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// The robot at rest in MuJoCo. Throws std::invalid_argument for a description or options that make no world.
std::unique_ptr<World> make_mujoco_world(const RobotDescription& robot, const WorldOptions& options);

}  // namespace koboshi::sim
