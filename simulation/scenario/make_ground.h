#pragma once

#include <cstdint>

#include "sim_board/world/ground.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Converts a scenario's ground for the world: fills in surface properties, tilts the shapes with the plane,
// and generates rough ground from its own seed or, by default, from `seed`.
sim_board::GroundDescription make_ground(const Ground& ground, std::uint64_t seed);

}  // namespace koboshi::simulation
