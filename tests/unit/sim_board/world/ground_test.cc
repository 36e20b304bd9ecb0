#include "sim_board/world/ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(StairBoxes, HaveTheRiseAndRun) {
  Stairs stairs{.X_WR = Isometry3d(Translation3d(1.0, 0.0, 0.0)),
                .count = 3,
                .rise_m = 0.02,
                .run_m = 0.1,
                .width_m = 0.4};
  stairs.X_WR.rotate(Eigen::AngleAxisd(90 * kDegree, Vector3d::UnitZ()));  // climbs along the world's y
  GroundDescription ground;
  ground.boxes = stair_boxes(stairs);
  ASSERT_EQ(ground.boxes.size(), 3u);
  for (int tread = 0; tread < 3; ++tread) {
    for (const double offset_m : {0.01, 0.05, 0.09}) {
      const Vector3d p_W(1.15, 0.1 * tread + offset_m, 0.5);
      EXPECT_NEAR(height_above(ground, p_W), 0.5 - 0.02 * (tread + 1), 1e-12) << tread << " " << offset_m;
    }
  }
  EXPECT_NEAR(height_above(ground, {1.0, -0.01, 0.5}), 0.5, 1e-12);  // before them
  EXPECT_NEAR(height_above(ground, {1.0, 0.31, 0.5}), 0.5, 1e-12);   // behind
  EXPECT_NEAR(height_above(ground, {1.21, 0.15, 0.5}), 0.5, 1e-12);  // beside
}

TEST(RampBox, RisesByItsAngleAndReachesThePlane) {
  const double angle_rad = 12 * kDegree;
  const GroundBox box = ramp_box({.X_WR = Isometry3d(Translation3d(0.5, 0.2, 0.0)),
                                  .length_m = 1.0,
                                  .width_m = 0.6,
                                  .angle_rad = angle_rad});
  GroundDescription ground;
  ground.boxes.push_back(box);
  for (const double offset_m : {0.01, 0.5, 0.99}) {
    // The distance is taken along the face's normal.
    const double expected = (0.5 - offset_m * std::tan(angle_rad)) * std::cos(angle_rad);
    EXPECT_NEAR(height_above(ground, {0.5 + offset_m, 0.0, 0.5}), expected, 1e-12) << offset_m;
  }
  EXPECT_NEAR(height_above(ground, {0.49, 0.2, 0.5}), 0.5, 1e-12);
  EXPECT_NEAR(height_above(ground, {0.7, 0.51, 0.5}), 0.5, 1e-12);
  // The lowest edge of the upper end lies on the plane: nothing can get below.
  const Vector3d edge_W = box.X_WG * Vector3d(0.5 * box.size_m.x(), 0.0, -0.5 * box.size_m.z());
  EXPECT_NEAR(edge_W.z(), 0.0, 1e-12);
}

TEST(FrictionPatch, ContainsPointsInsideItsOutline) {
  FrictionPatch patch;
  patch.X_WP = Translation3d(1.0, 0.0, 0.0) * Eigen::AngleAxisd(90 * kDegree, Vector3d::UnitZ());
  patch.size_m = {0.4, 0.2};
  EXPECT_TRUE(patch.holds({1.09, 0.19, 0.0}));
  EXPECT_FALSE(patch.holds({1.11, 0.0, 0.0}));
  EXPECT_FALSE(patch.holds({1.0, 0.21, 0.0}));
  patch.outline = FrictionPatch::Outline::kDisc;
  EXPECT_TRUE(patch.holds({1.14, 0.14, 0.0}));
  EXPECT_FALSE(patch.holds({1.15, 0.15, 0.0}));
}

HeightField tent() {  // one cell, one corner up
  HeightField field;
  field.size_m = {0.2, 0.1};
  field.columns = 2;
  field.rows = 2;
  field.heights_m = {0.0, 0.0, 0.0, 0.02};
  return field;
}

TEST(HeightField, HasTwoTrianglesPerCell) {
  const HeightField field = tent();
  EXPECT_NEAR(field.at({0.0, 0.0})->height_m, 0.01, 1e-12);  // on the diagonal
  EXPECT_NEAR(field.at({0.1, 0.05})->height_m, 0.02, 1e-12);
  EXPECT_NEAR(field.at({0.05, -0.05})->height_m, 0.0, 1e-12);  // right of it: the height of y alone
  EXPECT_NEAR(field.at({0.1, 0.0})->height_m, 0.01, 1e-12);
  EXPECT_NEAR(field.at({0.0, 0.05})->height_m, 0.01, 1e-12);  // left of it: of x alone
  EXPECT_NEAR(field.at({-0.1, 0.02})->height_m, 0.0, 1e-12);
  EXPECT_LT((field.at({0.05, -0.04})->normal_F - Vector3d(0.0, -0.2, 1.0).normalized()).norm(), 1e-12);
  EXPECT_LT((field.at({-0.05, 0.04})->normal_F - Vector3d(-0.1, 0.0, 1.0).normalized()).norm(), 1e-12);
  EXPECT_FALSE(field.at({0.101, 0.0}));
  EXPECT_FALSE(field.at({0.0, -0.051}));
}

TEST(HeightAbove, UsesTheHighestGround) {
  GroundDescription ground;
  ground.boxes.push_back(
      {.X_WG = Isometry3d(Translation3d(0.0, 0.0, 0.02)), .size_m = {0.2, 0.2, 0.04}, .surface = {}});
  ground.height_fields.push_back(tent());
  EXPECT_NEAR(height_above(ground, {0.0, 0.0, 0.1}), 0.06, 1e-12);
  EXPECT_NEAR(height_above(ground, {0.0, 0.0, 0.03}), -0.01, 1e-12);  // inside the box
  ground.boxes[0].X_WG = Translation3d(0.0, 0.0, 1.0);                // a roof
  EXPECT_NEAR(height_above(ground, {-0.05, -0.05, 0.1}), 0.1 / std::hypot(1.0, 0.2), 1e-12);
  ground.present = false;
  EXPECT_TRUE(std::isinf(height_above(ground, {5.0, 0.0, 0.1})));
}

// A board that stands on its edge, tilted by 70 degrees: the way up from its middle leaves it through a broad
// side.
TEST(HeightAbove, FindsTheFaceAboveAPointInATiltedBox) {
  for (const bool broad_along_x : {false, true}) {
    GroundDescription ground;
    ground.present = false;
    const double angle_rad = (broad_along_x ? 20.0 : 70.0) * std::numbers::pi / 180;
    const Eigen::Vector3d size_m =
        broad_along_x ? Eigen::Vector3d(0.4, 1.0, 0.1) : Eigen::Vector3d(0.1, 1.0, 0.4);
    ground.boxes.push_back({.X_WG = Isometry3d(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY())),
                            .size_m = size_m,
                            .surface = {}});
    EXPECT_NEAR(height_above(ground, {0.0, 0.0, 0.0}), -0.05, 1e-12);
    EXPECT_NEAR(height_above(ground, {0.0, 0.3, 0.01}),
                -0.05 + 0.01 * std::cos(20.0 * std::numbers::pi / 180), 1e-12);
    EXPECT_TRUE(std::isinf(height_above(ground, {0.0, 0.51, 0.0})));
    EXPECT_TRUE(std::isinf(height_above(ground, {0.0, 0.0, -0.1})));
  }
}

TEST(GroundCheck, RejectsInvalidGround) {
  GroundDescription ground;
  EXPECT_NO_THROW(check(ground));
  ground.height_fields.push_back(tent());
  EXPECT_NO_THROW(check(ground));
  ground.height_fields[0].heights_m.pop_back();
  EXPECT_THROW(check(ground), std::invalid_argument);
  ground.height_fields[0].heights_m.push_back(std::nan(""));
  EXPECT_THROW(check(ground), std::invalid_argument);
  ground.height_fields.clear();
  ground.boxes.emplace_back().size_m.y() = 0.0;
  EXPECT_THROW(check(ground), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::sim_board
