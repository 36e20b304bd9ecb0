#pragma once

#include <Eigen/Geometry>

namespace koboshi::sim {

// How far the box A would have to move, along the shortest way, until it only touches the box B, in m; zero
// for boxes that are apart. X_WA and X_WB are the poses of their centres, half_A_m and half_B_m half their
// sizes. Exact, by the separating axes of two convex polyhedra (Gottschalk, Lin and Manocha, "OBBTree",
// 1996).
[[nodiscard]] double box_overlap_m(const Eigen::Isometry3d& X_WA, const Eigen::Vector3d& half_A_m,
                                   const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& half_B_m);

}  // namespace koboshi::sim
