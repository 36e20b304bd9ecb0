#pragma once

#include <memory>

#include "sim_board/robot/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// The same world, held to the conservation of energy. Once in kCheck_s the energy of its links (motion and
// weight) is compared with what servos and pushes have put in; contacts, stops and the solver's corrections
// may only take. The difference is followed from its lowest value on, and a rise beyond
// options.energy_tolerance_J_per_kg times the robot's mass, and beyond what the ground's springs had taken in
// the last tenths of a second, ends the run: step() throws WorldBlewUp with time, the link that gained most
// and what it touched. None of the 200 falls of docs/experiment/contacts.md came to that; how much of the
// tolerance falls use was not measured.
//
// Work is torque times the mean of the speeds before and after a step, which for the solvers here is what the
// torque does to the kinetic energy, exactly; what the turning of the links adds is of second order in the
// step.
std::unique_ptr<World> guard_energy(std::unique_ptr<World> world, const RobotDescription& robot,
                                    const WorldOptions& options);

}  // namespace koboshi::sim
