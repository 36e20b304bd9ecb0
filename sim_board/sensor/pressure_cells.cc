#include "sim_board/sensor/pressure_cells.h"

#include <Eigen/QR>
#include <algorithm>
#include <cstddef>

namespace koboshi::sim_board {
namespace {

// The plate on those cells that press: forces in the span of (1, x, y), in balance with load and moments.
CellForces plate_forces(const CellPlaces& places_m, const std::array<bool, hal::kPressureCells>& presses,
                        double load_N, const Eigen::Vector2d& point_m) {
  Eigen::Matrix<double, 3, hal::kPressureCells> balance = decltype(balance)::Zero();
  for (std::size_t i = 0; i < places_m.size(); ++i)
    if (presses[i])
      balance.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(1.0, places_m[i].x(), places_m[i].y());
  const Eigen::Vector3d wrench = load_N * Eigen::Vector3d(1.0, point_m.x(), point_m.y());
  // The solution of least norm lies in the span of the rows: an affine function of the place.
  const Eigen::Vector4d forces = balance.completeOrthogonalDecomposition().solve(wrench);
  return {forces[0], forces[1], forces[2], forces[3]};
}

}  // namespace

CellForces distribute_load(const CellPlaces& places_m, double load_N, const Eigen::Vector2d& point_m) {
  if (load_N <= 0.0) return {};
  std::array<bool, hal::kPressureCells> presses{true, true, true, true};
  CellForces forces = plate_forces(places_m, presses, load_N, point_m);
  for (std::size_t lifted = 1; lifted < places_m.size(); ++lifted) {
    const auto least = std::ranges::min_element(forces);
    if (*least >= 0.0) break;
    presses[static_cast<std::size_t>(least - forces.begin())] = false;
    forces = plate_forces(places_m, presses, load_N, point_m);
  }
  // Fewer than three cells need not balance the moments, and then not the load either.
  double sum_N = 0.0;
  for (double& force_N : forces) sum_N += force_N = std::max(force_N, 0.0);
  for (double& force_N : forces) force_N *= sum_N > 0.0 ? load_N / sum_N : 0.0;
  return forces;
}

}  // namespace koboshi::sim_board
