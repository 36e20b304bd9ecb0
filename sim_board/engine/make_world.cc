#include "sim_board/engine/make_world.h"

#include <utility>

#include "sim_board/engine/free_bodies_world.h"
#include "sim_board/engine/guarded_world.h"
#include "sim_board/engine/mujoco/mujoco_world.h"
#include "sim_board/engine/ode/ode_world.h"

namespace koboshi::sim_board {

namespace {

std::unique_ptr<World> make_engine(const RobotDescription& robot, const WorldOptions& options) {
  if (options.stepper == Stepper::kMujoco) return make_mujoco_world(robot, options);
  return make_ode_world(robot, options);
}

}  // namespace

std::unique_ptr<World> make_world(const RobotDescription& robot, const WorldOptions& options) {
  std::unique_ptr<World> world = make_engine(robot, options);
  if (options.energy_tolerance_J_per_kg != 0.0) world = guard_energy(std::move(world), robot, options);
  if (options.free_bodies.empty()) return world;
  return add_free_bodies(std::move(world), robot, options);
}

}  // namespace koboshi::sim_board
