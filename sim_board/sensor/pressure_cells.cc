#include "sim_board/sensor/pressure_cells.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>

namespace koboshi::sim_board {
namespace {

// Cells count as on one line below this determinant of their spread, relative to the square of its trace.
constexpr double kLine = 1e-12;

// The plate on those cells that press: forces that are an affine function of the place, in balance with load
// and moments. Cells on one line balance only the moments along it, and a single cell none.
CellForces plate_forces(const CellPlaces& places_m, const std::array<bool, hal::kPressureCells>& presses,
                        double load_N, const Eigen::Vector2d& point_m) {
  double cells = 0.0;
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    if (!presses[i]) continue;
    cells += 1.0;
    centre_m += places_m[i];
  }
  centre_m /= cells;
  Eigen::Matrix2d spread_m2 = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < places_m.size(); ++i)
    if (presses[i]) spread_m2 += (places_m[i] - centre_m) * (places_m[i] - centre_m).transpose();
  const double trace_m2 = spread_m2.trace();
  const Eigen::Vector2d moment_Nm = load_N * (point_m - centre_m);
  Eigen::Vector2d slope_N_per_m = Eigen::Vector2d::Zero();
  if (spread_m2.determinant() > kLine * trace_m2 * trace_m2)
    slope_N_per_m = spread_m2.inverse() * moment_Nm;
  else if (trace_m2 > 0.0)
    slope_N_per_m = spread_m2 * moment_Nm / (trace_m2 * trace_m2);
  CellForces forces{};
  for (std::size_t i = 0; i < places_m.size(); ++i)
    if (presses[i]) forces[i] = load_N / cells + slope_N_per_m.dot(places_m[i] - centre_m);
  return forces;
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
