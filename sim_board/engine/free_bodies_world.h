#pragma once

#include <memory>

#include "sim_board/description/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Returns a world that adds the free bodies of the options to another one, whatever its engine. Bodies are
// integrated in parts of a step of at most a hundredth of a contact. Their contacts are springs by the bounce
// law (bounce_law.h) with Coulomb friction from a tangential spring (Cundall and Strack, "A discrete
// numerical model for granular assemblies", Geotechnique 29, 1979). During a step the robot's links move on
// as they did at its beginning; what they are pushed by, on average over the step, acts on them in the same
// step. Momentum is conserved to rounding; a link's velocity lags by half a step in the contacts, which is
// small beside a contact's time.
//
// Free bodies rest on the plane and on boxes. Throws std::invalid_argument for bodies on friction patches or
// height fields, and for invalid bodies.
std::unique_ptr<World> add_free_bodies(std::unique_ptr<World> world, const RobotDescription& robot,
                                       const WorldOptions& options);

}  // namespace koboshi::sim_board
