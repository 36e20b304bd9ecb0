#pragma once

#include <string>

#include "simulation/assembly/simulation.h"

namespace koboshi::simulation {

// Operator input to a running simulation, in the syntax of a scenario file
// (docs/reference/scenario-format.md) without times: everything takes effect at the next step. All functions
// throw InputError for input that a scenario could not contain, and then change nothing.

// `text` is one item of the list `commands`: "walk: {forward_m_per_s: 0.2}", "play: squat", "stop: true".
void command(Simulation& simulation, const std::string& text);
// `text` is one item of the list `pushes`: "{link: trunk, force_N: [30, 0, 0], duration_s: 0.1}".
void push(Simulation& simulation, const std::string& text);
// Reads such an item, which has one push, and checks it against the robot.
Push read_push(const std::string& text, const sim_board::RobotDescription& robot);
// `text` is one item of the list `faults`: "{kind: imu_stop, duration_s: 0.03}".
void fault(Simulation& simulation, const std::string& text);
// Reads such an item. Simulation::fault takes it once sim_board::check has passed.
Fault read_fault(const std::string& text);
// Sets a parameter of the controller (docs/reference/parameters.md), in the unit that its key ends with. The
// step in which the controller refuses it throws SdoFailed.
void write(Simulation& simulation, const std::string& key, double value);

}  // namespace koboshi::simulation
