#pragma once

#include <cstdint>

#include "sim_board/scenario/scenario.h"
#include "sim_board/world/ground.h"

namespace koboshi::sim {

// Converts a scenario's ground for the world: fills in surface properties, tilts the shapes with the plane,
// and generates rough ground from its own seed or, by default, from `seed`.
GroundDescription make_ground(const Ground& ground, std::uint64_t seed);

}  // namespace koboshi::sim
