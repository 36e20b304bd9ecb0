#pragma once

#include <cstdint>
#include <functional>

#include "sim_board/scenario/scenario.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/simulation.h"
#include "tools/lab/experiment/experiment.h"
#include "tools/lab/trial/perturbation.h"

namespace koboshi::tools {

// Asked after each millisecond whether there is nothing left to see.
using IsOver = std::function<bool(const simulation::RunRecorder&)>;
// The same of who looks at more than is recorded.
using Watch = std::function<bool(simulation::Simulation&, const simulation::RunRecorder&)>;

// Plays a scenario in this process, without leaving files, to its end or until it is over or the robot has
// fallen. The values are the numbers and truths of summary.json, and the outcome
// (tools/lab/trial/outcome.h). May be called from several threads at a time. Throws sim::InputError.
[[nodiscard]] Values play_scenario(const sim::Scenario& scenario, const simulation::RobotChange& change,
                                   const IsOver& is_over = {});

// The same in the world that a seed draws within these bounds.
[[nodiscard]] Values play_in_world(sim::Scenario scenario, const PerturbationBounds& bounds,
                                   std::uint64_t seed, const IsOver& is_over = {});

// The same, to its end or until the watch says so: who falls may get up again.
[[nodiscard]] Values watch_in_world(sim::Scenario scenario, const PerturbationBounds& bounds,
                                    std::uint64_t seed, const Watch& is_over);

}  // namespace koboshi::tools
