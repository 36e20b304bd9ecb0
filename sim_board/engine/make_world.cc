#include "sim_board/engine/make_world.h"

#include "sim_board/engine/mujoco/mujoco_world.h"
#include "sim_board/engine/ode/ode_world.h"

namespace koboshi::sim {

std::unique_ptr<World> make_world(const RobotDescription& robot, const WorldOptions& options) {
  if (options.stepper == Stepper::kMujoco) return make_mujoco_world(robot, options);
  return make_ode_world(robot, options);
}

}  // namespace koboshi::sim
