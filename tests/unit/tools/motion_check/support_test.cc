#include "tools/motion_check/support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace koboshi::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTolerance_m = 0.001;

// Two soles of 100 by 50 mm whose middles are 80 mm apart; the left one is `left_m` higher.
std::array<Vector3d, 8> soles(double left_m) {
  std::array<Vector3d, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const double middle_m = i < 4 ? 0.04 : -0.04;
    corners[i] = {(i % 4 & 1) != 0 ? 0.05 : -0.05, middle_m + ((i % 4 & 2) != 0 ? 0.025 : -0.025),
                  i < 4 ? left_m : 0.0};
  }
  return corners;
}

TEST(FindRest, StaysOnBothSolesWithTheCentreOfMassBetweenThem) {
  const Rest rest = find_rest(soles(0.0), {0.0, 0.0, 0.2}, Vector3d::UnitZ(), kTolerance_m);
  EXPECT_TRUE(rest.rests);
  EXPECT_EQ(rest.corners, 0xFFU);
  EXPECT_EQ(rest.tip_rad, 0.0);
}

TEST(FindRest, StandsOnTheLowerSoleAlone) {
  const Rest rest = find_rest(soles(0.01), {0.0, -0.04, 0.2}, Vector3d::UnitZ(), kTolerance_m);
  EXPECT_TRUE(rest.rests);
  EXPECT_EQ(rest.corners, 0xF0U);
}

// The centre of mass is between the feet: the body rolls over the lower sole's inner edge, at y = -0.015,
// until the higher sole's outer edge, at y = 0.065, touches: by atan(10 mm / 80 mm).
TEST(FindRest, RollsUntilTheHigherSoleTouches) {
  const Rest rest = find_rest(soles(0.01), {0.0, 0.02, 0.2}, Vector3d::UnitZ(), kTolerance_m);
  EXPECT_TRUE(rest.rests);
  EXPECT_NEAR(rest.tip_rad, std::atan(0.01 / 0.08), 1e-9);
  EXPECT_NE(rest.corners & 0x0FU, 0U);
  EXPECT_NE(rest.corners & 0xF0U, 0U);
  EXPECT_LT(rest.up_B.y(), 0.0) << "leans to the left";
}

TEST(FindRest, TipsOverWithTheCentreOfMassInFrontOfTheSoles) {
  const Rest rest = find_rest(soles(0.0), {0.06, 0.0, 0.2}, Vector3d::UnitZ(), kTolerance_m);
  EXPECT_FALSE(rest.rests);
  EXPECT_EQ(rest.corners, 0xFFU);
  EXPECT_EQ(rest.up_B, Vector3d::UnitZ());
}

TEST(MarginIn, IsPositiveInsideAndPointsAcrossTheNearestEdge) {
  const std::array<Vector2d, 4> square{Vector2d(0, 0), Vector2d(1, 0), Vector2d(1, 1), Vector2d(0, 1)};
  const Margin inside = margin_in(square, {0.9, 0.5});
  EXPECT_NEAR(inside.distance_m, 0.1, 1e-12);
  EXPECT_NEAR(inside.outward.x(), 1.0, 1e-12);
  const Margin outside = margin_in(square, {0.5, -0.2});
  EXPECT_NEAR(outside.distance_m, -0.2, 1e-12);
  EXPECT_NEAR(outside.outward.y(), -1.0, 1e-12);
}

TEST(MarginIn, OfAnEdgeIsNeverPositive) {
  const std::array<Vector2d, 2> edge{Vector2d(0, 0), Vector2d(1, 0)};
  EXPECT_NEAR(margin_in(edge, {0.5, 0.3}).distance_m, -0.3, 1e-12);
  EXPECT_LE(margin_in(edge, {0.5, 0.0}).distance_m, 0.0);
}

}  // namespace
}  // namespace koboshi::tools
