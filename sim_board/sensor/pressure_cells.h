#pragma once

#include <Eigen/Core>
#include <array>

#include "hal/port/ankle.h"

namespace koboshi::sim_board {

using CellPlaces = std::array<Eigen::Vector2d, hal::kPressureCells>;
using CellForces = std::array<double, hal::kPressureCells>;

// Distributes a load at a point of the sole among four cells below a stiff plate. The cells are equal springs
// that cannot pull: the forces are f_i = a + b x_i + c y_i with the load and its two moments in balance, and
// a cell that would pull takes none, so that the others bear the load. A point outside of the cells is borne
// by the nearest of them, with the moments as near as they come.
CellForces distribute_load(const CellPlaces& places_m, double load_N, const Eigen::Vector2d& point_m);

}  // namespace koboshi::sim_board
