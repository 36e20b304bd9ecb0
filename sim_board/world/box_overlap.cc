#include "sim_board/world/box_overlap.h"

#include <algorithm>
#include <cmath>

namespace koboshi::sim {

double box_overlap_m(const Eigen::Isometry3d& X_WA, const Eigen::Vector3d& half_A_m,
                     const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& half_B_m) {
  // The cross product of parallel edges is zero; the face normals already cover this case.
  constexpr double kParallel = 1e-6;
  const Eigen::Matrix3d& A = X_WA.linear();
  const Eigen::Matrix3d& B = X_WB.linear();
  const Eigen::Vector3d p_AB_W = X_WB.translation() - X_WA.translation();
  const auto overlap_along = [&](const Eigen::Vector3d& axis) {
    const double reach_m =
        (A.transpose() * axis).cwiseAbs().dot(half_A_m) + (B.transpose() * axis).cwiseAbs().dot(half_B_m);
    return reach_m - std::abs(p_AB_W.dot(axis));
  };
  double overlap_m = overlap_along(A.col(0));
  for (int i = 0; i < 3 && overlap_m > 0.0; ++i) {
    overlap_m = std::min({overlap_m, overlap_along(A.col(i)), overlap_along(B.col(i))});
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d edge = A.col(i).cross(B.col(j));
      const double sine = edge.norm();
      if (sine > kParallel) overlap_m = std::min(overlap_m, overlap_along(edge / sine));
    }
  }
  return std::max(0.0, overlap_m);
}

}  // namespace koboshi::sim
