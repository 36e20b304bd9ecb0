#include "studio/view/camera_control.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace koboshi::studio {
namespace {

constexpr int kWidth_px = 640;
constexpr int kHeight_px = 480;

view::Camera camera() {
  view::Camera camera;
  camera.target_W_m = {0.3, -0.2, 0.25};
  camera.azimuth_rad = 0.8;
  camera.elevation_rad = 0.3;
  camera.distance_m = 1.4;
  return camera;
}

TEST(CameraControl, ARayHitsThePointThatItsPixelShows) {
  for (const Eigen::Vector3d& p_W_m :
       {Eigen::Vector3d(0.3, -0.2, 0.25), Eigen::Vector3d(0.1, 0.05, 0.4), Eigen::Vector3d(0.5, -0.3, 0.0)}) {
    const Eigen::Vector2d pixel = view::project(camera(), kWidth_px, kHeight_px, p_W_m);
    const Ray ray = ray_through(camera(), kWidth_px, kHeight_px, pixel);
    EXPECT_NEAR(ray.direction_W.norm(), 1.0, 1e-9);
    EXPECT_LT((p_W_m - ray.origin_W_m).cross(ray.direction_W).norm(), 1e-5) << p_W_m.transpose();
  }
}

TEST(CameraControl, ADisplacementIsSeenAsItsDrag) {
  const Eigen::Vector3d p_W_m(0.2, 0.0, 0.3);
  const Eigen::Vector2d drag_px(37.0, -21.0);
  const Eigen::Vector3d moved_W_m = p_W_m + displacement_W_m(camera(), kHeight_px, p_W_m, drag_px);
  const Eigen::Vector2d seen_px = view::project(camera(), kWidth_px, kHeight_px, moved_W_m) -
                                  view::project(camera(), kWidth_px, kHeight_px, p_W_m);
  EXPECT_NEAR(seen_px.x(), drag_px.x(), 0.01);
  EXPECT_NEAR(seen_px.y(), drag_px.y(), 0.01);
}

TEST(CameraControl, PanningKeepsTheTargetUnderTheMouse) {
  view::Camera moved = camera();
  pan(moved, {50.0, 30.0}, kHeight_px);
  const Eigen::Vector2d seen_px = view::project(moved, kWidth_px, kHeight_px, camera().target_W_m);
  EXPECT_NEAR(seen_px.x(), 0.5 * kWidth_px + 50.0, 0.01);
  EXPECT_NEAR(seen_px.y(), 0.5 * kHeight_px + 30.0, 0.01);
}

TEST(CameraControl, DistanceStaysWithinItsBounds) {
  view::Camera close = camera();
  for (int i = 0; i < 100; ++i) zoom(close, 1.5);
  EXPECT_EQ(close.distance_m, kNearest_m);
  for (int i = 0; i < 100; ++i) zoom(close, 0.5);
  EXPECT_EQ(close.distance_m, kFarthest_m);
}

// Level ground, and ground that falls to the right.
const std::vector<view::Plane> kGrounds[] = {{{}}, {{Eigen::Vector3d(0.1, 0.3, 1.0).normalized(), -0.02}}};

double clearance_m(const view::Plane& plane, const Eigen::Vector3d& p_W_m) {
  return plane.normal_W.dot(p_W_m) - plane.offset_m;
}

TEST(CameraControl, NoDragOrWheelLeadsBelowTheGround) {
  const std::uint32_t seed = 40;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> pixels(-300.0, 300.0);
  for (const std::vector<view::Plane>& ground : kGrounds) {
    view::Camera moved = camera();
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d drag_px(pixels(random), pixels(random));
      if (i % 3 == 0) {
        orbit(moved, drag_px, kHeight_px);
        raise_above(moved, ground);
      } else if (i % 3 == 1) {
        pan(moved, drag_px, kHeight_px);
        lift_above(moved, ground);
      } else {
        zoom(moved, std::exp(0.01 * drag_px.x()));
        raise_above(moved, ground);
      }
      ASSERT_GT(clearance_m(ground[0], moved.eye_W_m()), kClearance_m - 1e-4) << "seed " << seed << ", " << i;
      ASSERT_GT(clearance_m(ground[0], moved.target_W_m), -1e-9) << "seed " << seed << ", " << i;
    }
  }
}

TEST(CameraControl, AboveTheGroundNothingChanges) {
  for (const std::vector<view::Plane>& ground : kGrounds) {
    view::Camera moved = camera();
    raise_above(moved, ground);
    lift_above(moved, ground);
    EXPECT_EQ(moved.elevation_rad, camera().elevation_rad);
    EXPECT_EQ(moved.target_W_m, camera().target_W_m);
  }
}

TEST(CameraControl, AMovementIntoTheGroundKeepsTheDirection) {
  view::Camera moved = camera();
  pan(moved, {0.0, -2000.0}, kHeight_px);
  lift_above(moved, kGrounds[0]);
  EXPECT_EQ(moved.elevation_rad, camera().elevation_rad);
  EXPECT_NEAR(moved.target_W_m.z(), 0.0, 1e-12);
}

}  // namespace
}  // namespace koboshi::studio
