#pragma once

#include <memory>

#include "sim_board/description/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Returns a world that checks energy conservation. Every kCheck_s it compares the kinetic and potential
// energy of the links with the work of servos and pushes; contacts, stops and the solver's corrections may
// only dissipate. It monitors the rise of the difference above its minimum. If the rise exceeds
// options.energy_tolerance_J_per_kg times the robot's mass plus the energy recently stored in the ground's
// springs (some tenths of a second), step() throws WorldBlewUp with the time, the link that gained most, and
// its contacts. None of the 200 falls of docs/experiment/contacts.md exceeded this limit; how much of the
// tolerance falls use was not measured.
//
// Work is torque times the mean of the speeds before and after a step. For these solvers that is exactly the
// torque's effect on the kinetic energy; the rotation of the links adds a term of second order in the step.
std::unique_ptr<World> guard_energy(std::unique_ptr<World> world, const RobotDescription& robot,
                                    const WorldOptions& options);

}  // namespace koboshi::sim_board
