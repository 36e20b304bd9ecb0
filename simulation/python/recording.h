#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::simulation {

// Returns rows of the trace (WatchedSimulation::take_rows) of one or several simulations of a robot as a
// structured array: one field for each column of trace.csv, under its title; the four columns of each joint
// are fields with one value for each joint. `by_world` adds a leading dimension, the simulation; without it
// there must be one. Throws std::invalid_argument if the simulations have different numbers of rows.
pybind11::object recording(const std::vector<std::vector<double>>& rows,
                           const sim_board::RobotDescription& robot, bool by_world);

}  // namespace koboshi::simulation
