#include "sim_board/world/box_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace koboshi::sim_board {

namespace {

// Calls `visit` with the 15 axes, unit vectors, until it returns false.
template <typename Visit>
void for_each_axis(const Eigen::Matrix3d& A, const Eigen::Matrix3d& B, const Visit& visit) {
  // The cross product of parallel edges is zero; the face normals already cover this case.
  constexpr double kParallel = 1e-6;
  for (int i = 0; i < 3; ++i) {
    if (!visit(A.col(i)) || !visit(B.col(i))) return;
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d edge = A.col(i).cross(B.col(j));
      const double sine = edge.norm();
      if (sine > kParallel && !visit(edge / sine)) return;
    }
  }
}

}  // namespace

double box_overlap_m(const Eigen::Isometry3d& X_WA, const Eigen::Vector3d& half_A_m,
                     const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& half_B_m) {
  const Eigen::Matrix3d& A = X_WA.linear();
  const Eigen::Matrix3d& B = X_WB.linear();
  const Eigen::Vector3d p_AB_W = X_WB.translation() - X_WA.translation();
  double overlap_m = std::numeric_limits<double>::infinity();
  for_each_axis(A, B, [&](const Eigen::Vector3d& axis) {
    const double reach_m =
        (A.transpose() * axis).cwiseAbs().dot(half_A_m) + (B.transpose() * axis).cwiseAbs().dot(half_B_m);
    overlap_m = std::min(overlap_m, reach_m - std::abs(p_AB_W.dot(axis)));
    return overlap_m > 0.0;
  });
  return std::max(0.0, overlap_m);
}

BoxSeparation box_separation(const Eigen::Isometry3d& X_WA, const Eigen::Vector3d& half_A_m,
                             const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& half_B_m) {
  const Eigen::Matrix3d& A = X_WA.linear();
  const Eigen::Matrix3d& B = X_WB.linear();
  const Eigen::Vector3d p_BA_W = X_WA.translation() - X_WB.translation();
  BoxSeparation most{.gap_m = -std::numeric_limits<double>::infinity()};
  for_each_axis(A, B, [&](const Eigen::Vector3d& axis) {
    const double reach_m =
        (A.transpose() * axis).cwiseAbs().dot(half_A_m) + (B.transpose() * axis).cwiseAbs().dot(half_B_m);
    const double along_m = p_BA_W.dot(axis);
    const double gap_m = std::abs(along_m) - reach_m;
    if (gap_m > most.gap_m) most = {gap_m, along_m < 0.0 ? Eigen::Vector3d(-axis) : axis};
    return true;
  });
  return most;
}

}  // namespace koboshi::sim_board
