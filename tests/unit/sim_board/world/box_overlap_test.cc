#include "sim_board/world/box_overlap.h"

#include <gtest/gtest.h>

#include <numbers>

namespace koboshi::sim_board {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

const Vector3d kBar_m(0.5, 0.1, 0.2);

TEST(BoxOverlap, IsTheShortestSeparationOfBoxesSideBySide) {
  const auto at = [](double x, double y, double z) {
    return box_overlap_m(Isometry3d::Identity(), kBar_m, Isometry3d(Translation3d(x, y, z)), kBar_m);
  };
  EXPECT_NEAR(at(0.9, 0.0, 0.0), 0.1, 1e-12);
  EXPECT_NEAR(at(0.1, -0.15, 0.1), 0.05, 1e-12);
  EXPECT_EQ(at(0.0, 0.0, 0.41), 0.0);
  EXPECT_EQ(at(1.01, 0.0, 0.0), 0.0);
}

// The edge of one that stands on its edge, above the face of the other: half a diagonal high.
TEST(BoxOverlap, FindsAnEdgeInAFace) {
  const Vector3d half_m(0.1, 0.1, 0.1);
  const Isometry3d X_WB = Translation3d(0.0, 0.0, 0.1 + 0.1 * std::numbers::sqrt2 - 0.003) *
                          AngleAxisd(0.25 * std::numbers::pi, Vector3d::UnitX());
  EXPECT_NEAR(box_overlap_m(Isometry3d::Identity(), half_m, X_WB, half_m), 0.003, 1e-12);
}

// Two edges that cross: only the axis across both tells how deep, and that they are apart.
TEST(BoxOverlap, FindsCrossedEdges) {
  const Vector3d half_m(0.1, 0.1, 1.0);
  const double diagonal_m = 0.1 * std::numbers::sqrt2;
  const Isometry3d X_WA(AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()) *
                        AngleAxisd(0.25 * std::numbers::pi, Vector3d::UnitZ()));
  const auto at = [&](double z) {
    const Isometry3d X_WB = Translation3d(0.0, 0.0, z) *
                            AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitY()) *
                            AngleAxisd(0.25 * std::numbers::pi, Vector3d::UnitZ());
    return box_overlap_m(X_WA, half_m, X_WB, half_m);
  };
  EXPECT_NEAR(at(2.0 * diagonal_m - 0.002), 0.002, 1e-12);
  EXPECT_EQ(at(2.0 * diagonal_m + 0.001), 0.0);
}

}  // namespace
}  // namespace koboshi::sim_board
