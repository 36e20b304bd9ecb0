#pragma once

#include <cstdint>
#include <optional>

#include "sim_board/description/description.h"
#include "simulation/disturbance/disturbed_world.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Returns what the scenario's world draws for a robot in a run with the scenario's seed. Empty if the
// scenario has no world.
[[nodiscard]] std::optional<DisturbedWorld> draw_world(const Scenario& scenario,
                                                       const sim_board::RobotDescription& robot);

// Changes the ground and the controller's clock of a scenario to those of the world. The scenario then has no
// world any more: it cannot be drawn twice.
void apply(const DisturbedWorld& world, Scenario& scenario);

}  // namespace koboshi::simulation
