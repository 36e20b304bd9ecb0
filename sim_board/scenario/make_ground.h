#pragma once

#include <cstdint>

#include "sim_board/scenario/scenario.h"
#include "sim_board/world/ground.h"

namespace koboshi::sim {

// The ground of a scenario as the world gets it: surfaces filled in, shapes turned with the plane, rough
// ground made from its seed or else from this one.
GroundDescription make_ground(const Ground& ground, std::uint64_t seed);

}  // namespace koboshi::sim
