#include "sim_board/world/placement.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

const Vector3d kHalf_m(0.05, 0.03, 0.01);

double lift(const Isometry3d& X_WB, const GroundDescription& ground) {
  const std::array poses{X_WB};
  return lift_onto_ground(sample_box(1.0, 2.0 * kHalf_m), poses, ground);
}

TEST(Placement, PlacesTheLowestPointOnThePlane) {
  GroundDescription ground;
  EXPECT_NEAR(lift(Isometry3d::Identity(), ground), 0.01, 1e-12);
  EXPECT_NEAR(lift(Isometry3d(Translation3d(0, 0, 1)), ground), 0.01 - 1.0, 1e-12);
  ground.normal_W = {std::sin(0.2), 0.0, std::cos(0.2)};
  const double reach_m = 0.05 * std::sin(0.2) + 0.01 * std::cos(0.2);
  EXPECT_NEAR(lift(Isometry3d::Identity(), ground), reach_m / std::cos(0.2), 1e-12);
}

TEST(Placement, StandsOnTheHighestBoxUnderIt) {
  GroundDescription ground;
  ground.boxes.push_back(
      {.X_WG = Isometry3d(Translation3d(0.08, 0, 0.02)), .size_m = {0.1, 1, 0.04}, .surface = {}});
  EXPECT_NEAR(lift(Isometry3d::Identity(), ground), 0.05, 1e-12);
  EXPECT_NEAR(lift(Isometry3d(Translation3d(-0.03, 0, 0)), ground), 0.01, 1e-12);  // beside it
  // A ridge under the middle, which no corner of either touches.
  ground.boxes[0] = {
      .X_WG = Translation3d(0, 0, 0.02) * AngleAxisd(0.25 * std::numbers::pi, Vector3d::UnitX()),
      .size_m = {1.0, 0.02, 0.02},
      .surface = {}};
  EXPECT_NEAR(lift(Isometry3d::Identity(), ground), 0.01 + 0.02 + 0.01 * std::sqrt(2.0), 1e-12);
  // Edge on edge, crossed.
  const Isometry3d on_edge(AngleAxisd(0.25 * std::numbers::pi, Vector3d::UnitY()));
  EXPECT_NEAR(lift(on_edge, ground), (0.05 + 0.01) / std::sqrt(2.0) + 0.02 + 0.01 * std::sqrt(2.0), 1e-12);
}

TEST(Placement, FallsToABoxBelowAPlaneThatIsNotThere) {
  GroundDescription ground;
  ground.present = false;
  EXPECT_EQ(lift(Isometry3d::Identity(), ground), 0.0);
  ground.boxes.push_back(
      {.X_WG = Isometry3d(Translation3d(0, 0, -1.02)), .size_m = {0.1, 1, 0.04}, .surface = {}});
  EXPECT_NEAR(lift(Isometry3d::Identity(), ground), 0.01 - 1.0, 1e-12);
}

TEST(Placement, StandsOnTheBumpsOfAHeightField) {
  GroundDescription ground;
  HeightField field;
  field.size_m = {0.4, 0.4};
  field.columns = field.rows = 41;
  field.heights_m.assign(41 * 41, 0.004);
  field.heights_m[20 * 41 + 22] = 0.012;  // at (0.02, 0)
  ground.height_fields.push_back(field);
  EXPECT_NEAR(lift(Isometry3d::Identity(), ground), 0.012 + 0.01, 1e-12);
  EXPECT_NEAR(lift(Isometry3d(Translation3d(-0.1, 0, 0)), ground), 0.004 + 0.01, 1e-12);
  EXPECT_NEAR(lift(Isometry3d(Translation3d(0.3, 0, 0)), ground), 0.01, 1e-12);
}

}  // namespace
}  // namespace koboshi::sim_board
