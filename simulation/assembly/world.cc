#include "simulation/assembly/world.h"

namespace koboshi::simulation {

std::optional<DisturbedWorld> draw_world(const Scenario& scenario, const sim_board::RobotDescription& robot) {
  if (!scenario.world) return std::nullopt;
  return draw_world(scenario.world->ranges, robot, scenario.world->seed.value_or(scenario.seed));
}

void apply(const DisturbedWorld& world, Scenario& scenario) {
  if (world.friction) {
    scenario.ground.friction = *world.friction;
    scenario.ground.friction_second.reset();
  }
  scenario.ground.roll_rad += world.roll_rad();
  scenario.ground.pitch_rad += world.pitch_rad();
  scenario.tick_jitter_us += world.tick_jitter_us();
  scenario.world.reset();
}

}  // namespace koboshi::simulation
