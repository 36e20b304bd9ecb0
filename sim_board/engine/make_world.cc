#include "sim_board/engine/make_world.h"

#include "sim_board/engine/ode/ode_world.h"

namespace koboshi::sim {

std::unique_ptr<World> make_world(const RobotDescription& robot, const WorldOptions& options) {
  return make_ode_world(robot, options);
}

}  // namespace koboshi::sim
