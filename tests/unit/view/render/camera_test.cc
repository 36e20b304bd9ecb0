#include "view/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/sample_recording.h"
#include "view/render/camera_path.h"

namespace koboshi::view {
namespace {

constexpr int kWidth_px = 800;
constexpr int kHeight_px = 400;

Camera from_the_left() {
  return {.target_W_m = {1.0, 2.0, 0.5}, .azimuth_rad = std::numbers::pi / 2.0, .distance_m = 3.0};
}

TEST(Camera, ShowsTheTargetInTheMiddle) {
  Camera camera = from_the_left();
  camera.elevation_rad = 0.4;
  const Eigen::Vector2d p_px = project(camera, kWidth_px, kHeight_px, camera.target_W_m);
  EXPECT_NEAR(p_px.x(), 400.0, 1e-3);
  EXPECT_NEAR(p_px.y(), 200.0, 1e-3);
}

// A robot that faces x, seen from its left, looks to the left side of the picture.
TEST(Camera, SeesForwardOnTheLeftWhenItIsOnTheRobotsLeft) {
  const Camera camera = from_the_left();
  const Eigen::Vector3d ahead_m = camera.target_W_m + Eigen::Vector3d(0.2, 0.0, 0.0);
  const Eigen::Vector3d above_m = camera.target_W_m + Eigen::Vector3d(0.0, 0.0, 0.2);
  // By the pinhole: 200 px per tan of half the field of view, at 3 m.
  const double expected_px = 200.0 / std::tan(0.5 * camera.field_of_view_rad) * 0.2 / 3.0;
  EXPECT_NEAR(project(camera, kWidth_px, kHeight_px, ahead_m).x(), 400.0 - expected_px, 0.01);
  EXPECT_NEAR(project(camera, kWidth_px, kHeight_px, above_m).y(), 200.0 - expected_px, 0.01);
}

TEST(Camera, IsWhereItsAnglesSay) {
  Camera camera = from_the_left();
  EXPECT_LT((camera.eye_W_m() - Eigen::Vector3d(1.0, 5.0, 0.5)).norm(), 1e-9);
  camera.elevation_rad = std::numbers::pi / 2.0;
  EXPECT_NEAR(camera.eye_W_m().z(), 3.5, 1e-4);
  EXPECT_TRUE(camera.view().allFinite()) << "from the zenith, too";
}

TEST(Camera, FitsASphereIntoTheNarrowerSide) {
  Camera camera = from_the_left();
  for (const double aspect : {0.5, 2.0}) {
    camera.distance_m = distance_to_fit(camera, aspect, 0.3);
    const double narrow_rad = aspect > 1.0 ? 0.5 * camera.field_of_view_rad
                                           : std::atan(aspect * std::tan(0.5 * camera.field_of_view_rad));
    EXPECT_NEAR(std::asin(0.3 / camera.distance_m), narrow_rad, 1e-9) << aspect;
  }
}

TEST(CameraPath, FollowsTheRobotAndStaysWhenFixed) {
  const Recording recording = test::sample_recording();  // moves 3 m along x in 3 s
  const Interval all{10'000, 3'000'000};
  const CameraPath follow(recording, {.motion = CameraMotion::kFollow}, all, 1.5);
  const CameraPath fixed(recording, {.motion = CameraMotion::kFixed}, all, 1.5);
  const double way_m = follow.at(2'000'000).target_W_m.x() - follow.at(1'000'000).target_W_m.x();
  EXPECT_NEAR(way_m, 1.0, 0.02);
  EXPECT_EQ(fixed.at(0).eye_W_m(), fixed.at(3'000'000).eye_W_m());
  EXPECT_NEAR(fixed.at(0).target_W_m.x(), 1.5, 0.02);
}

TEST(CameraPath, OfTheWholeWayShowsTheRobotAtBothEnds) {
  const Recording recording = test::sample_recording();
  const Interval all{10'000, 3'000'000};
  const CameraPath fixed(recording, {.motion = CameraMotion::kFixed}, all, 2.0);
  for (const Sample& sample : {recording.samples.front(), recording.samples.back()}) {
    for (const Pose& link : sample.links) {
      const Eigen::Vector2d p_px = project(fixed.at(0), kWidth_px, kHeight_px, link.p_WL_m.cast<double>());
      EXPECT_GT(p_px.x(), 0.0);
      EXPECT_LT(p_px.x(), kWidth_px);
      EXPECT_GT(p_px.y(), 0.0);
      EXPECT_LT(p_px.y(), kHeight_px);
    }
  }
}

TEST(CameraPath, OrbitsAtItsRate) {
  const Recording recording = test::sample_recording();
  const CameraChoice choice{.motion = CameraMotion::kOrbit, .azimuth_rad = 0.2, .orbit_rad_per_s = 0.5};
  const CameraPath orbit(recording, choice, {1'000'000, 3'000'000}, 1.0);
  EXPECT_DOUBLE_EQ(orbit.at(1'000'000).azimuth_rad, 0.2);
  EXPECT_DOUBLE_EQ(orbit.at(3'000'000).azimuth_rad, 1.2);
}

}  // namespace
}  // namespace koboshi::view
