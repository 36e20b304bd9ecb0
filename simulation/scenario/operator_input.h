#pragma once

#include <string>

#include "simulation/scenario/simulation.h"

namespace koboshi::simulation {

// What an operator does to a simulation, in the words of a scenario file (docs/reference/scenario-format.md)
// without its time: everything begins with the next step. All throw sim::InputError for what a scenario may
// not contain either, and change nothing then.

// `text` is one item of the list `commands`: "walk: {forward_m_per_s: 0.2}", "play: squat", "stop: true".
void command(Simulation& simulation, const std::string& text);
// `text` is one item of the list `pushes`: "{link: trunk, force_N: [30, 0, 0], duration_s: 0.1}".
void push(Simulation& simulation, const std::string& text);
// Sets a parameter of the controller (docs/reference/parameters.md), in the unit that its key ends with. The
// step in which the controller refuses it throws sim::SdoFailed.
void write(Simulation& simulation, const std::string& key, double value);

}  // namespace koboshi::simulation
