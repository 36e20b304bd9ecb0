#pragma once

#include <Eigen/Geometry>

namespace koboshi::sim_board {

// Returns the penetration depth of the boxes A and B in m: the shortest translation of A after which the
// boxes only touch. Zero for separate boxes. X_WA and X_WB are the poses of their centres, half_A_m and
// half_B_m half their sizes. Exact, by the separating axes of two convex polyhedra (Gottschalk, Lin and
// Manocha, "OBBTree", 1996).
[[nodiscard]] double box_overlap_m(const Eigen::Isometry3d& X_WA, const Eigen::Vector3d& half_A_m,
                                   const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& half_B_m);

// Distance along the axis that separates two boxes most.
struct BoxSeparation {
  double gap_m = 0.0;                              // negative if they overlap
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitZ();  // unit vector of the axis, from B to A
};

// Returns the separation of the boxes A and B, by the same axes. Separate boxes are at least this far apart;
// farther if they are next to each other with a corner or an edge that lies beside the other's faces.
[[nodiscard]] BoxSeparation box_separation(const Eigen::Isometry3d& X_WA, const Eigen::Vector3d& half_A_m,
                                           const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& half_B_m);

}  // namespace koboshi::sim_board
