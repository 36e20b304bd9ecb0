#include "sim_board/world/support_polygon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace koboshi::sim_board {
namespace {

using Eigen::Vector2d;
using ::testing::ElementsAre;

TEST(ConvexHull, IsCounterClockwiseWithoutInteriorAndCollinearPoints) {
  EXPECT_THAT(convex_hull({{1, 1}, {0, 0}, {0.5, 0.5}, {1, 0}, {0.5, 0}, {0, 1}, {0, 0}}),
              ElementsAre(Vector2d(0, 0), Vector2d(1, 0), Vector2d(1, 1), Vector2d(0, 1)));
}

TEST(ConvexHull, OfTwoFeetReachesFromHeelToToe) {
  // The left foot a step ahead of the right one.
  EXPECT_THAT(convex_hull({{0.03, 0.02},
                           {0.13, 0.02},
                           {0.13, 0.08},
                           {0.03, 0.08},
                           {0, -0.02},
                           {0.1, -0.02},
                           {0.1, -0.08},
                           {0, -0.08}}),
              ElementsAre(Vector2d(0, -0.08), Vector2d(0.1, -0.08), Vector2d(0.13, 0.02),
                          Vector2d(0.13, 0.08), Vector2d(0.03, 0.08), Vector2d(0, -0.02)));
}

TEST(ConvexHull, OfCollinearPointsIsTheSegmentsEnds) {
  EXPECT_THAT(convex_hull({{0, 0}, {1, 1}, {2, 2}}), ElementsAre(Vector2d(0, 0), Vector2d(2, 2)));
  EXPECT_THAT(convex_hull({{1, 1}, {1, 1}}), ElementsAre(Vector2d(1, 1)));
  EXPECT_THAT(convex_hull({}), ElementsAre());
}

TEST(DistanceInside, IsPositiveInsideAndNegativeOutside) {
  const auto foot = convex_hull({{0, 0}, {0.1, 0}, {0.1, 0.06}, {0, 0.06}});
  EXPECT_NEAR(distance_inside(foot, {0.05, 0.03}), 0.03, 1e-15);
  EXPECT_NEAR(distance_inside(foot, {0.09, 0.03}), 0.01, 1e-15);
  EXPECT_NEAR(distance_inside(foot, {0.1, 0.03}), 0.0, 1e-15);
  EXPECT_NEAR(distance_inside(foot, {0.12, 0.03}), -0.02, 1e-15);
  EXPECT_NEAR(distance_inside(foot, {0.13, 0.10}), -0.05, 1e-15);  // from a corner
}

TEST(DistanceInside, IsNeverPositiveForALineAPointOrAnEmptyHull) {
  EXPECT_NEAR(distance_inside(convex_hull({{0, 0}, {0.1, 0}}), {0.05, 0.02}), -0.02, 1e-15);
  EXPECT_NEAR(distance_inside(convex_hull({{0, 0}, {0.1, 0}}), {0.05, 0}), 0.0, 1e-15);
  EXPECT_NEAR(distance_inside(convex_hull({{0, 0}}), {0.03, 0.04}), -0.05, 1e-15);
  EXPECT_EQ(distance_inside({}, {0, 0}), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace koboshi::sim_board
