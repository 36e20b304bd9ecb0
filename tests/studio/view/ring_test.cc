#include "studio/view/ring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace koboshi::studio {
namespace {

constexpr int kRingView_px = 800;
constexpr int kRingViewHeight_px = 600;
constexpr double kSingle = 1e-5;  // the matrices of a camera are of single precision
constexpr double kPi = std::numbers::pi;

const Gizmo kRings{{0.05, 0.02, 0.1}, 0.15, true};

// Looks at the gizmo from all sides, from above and from below.
std::vector<view::Camera> ring_cameras() {
  std::vector<view::Camera> cameras;
  for (const double elevation_rad : {-0.9, -0.4, 0.5, 1.2})
    for (const double azimuth_rad : {-2.6, -0.9, 0.6, 2.2}) {
      view::Camera camera;
      camera.target_W_m = {0.0, 0.0, 0.15};
      camera.azimuth_rad = azimuth_rad;
      camera.elevation_rad = elevation_rad;
      cameras.push_back(camera);
    }
  return cameras;
}

view::Camera level_camera(double azimuth_rad) {
  view::Camera camera;
  camera.target_W_m = kRings.p_W_m;
  camera.azimuth_rad = azimuth_rad;
  return camera;
}

// A point of a ring: the angle is counted from the next axis in the order x, y, z, x.
Eigen::Vector3d on_ring_W_m(int axis, double angle_rad) {
  Eigen::Vector3d p_W_m = kRings.p_W_m;
  p_W_m[(axis + 1) % 3] += kRings.ring_m() * std::cos(angle_rad);
  p_W_m[(axis + 2) % 3] += kRings.ring_m() * std::sin(angle_rad);
  return p_W_m;
}

Eigen::Vector2d image_px(const view::Camera& camera, const Eigen::Vector3d& p_W_m) {
  return view::project(camera, kRingView_px, kRingViewHeight_px, p_W_m);
}

std::optional<Handle> picked(const Gizmo& gizmo, const view::Camera& camera, const Eigen::Vector2d& pixel) {
  return pick_handle(gizmo, camera, kRingView_px, kRingViewHeight_px, pixel);
}

double distance_px(const Gizmo& gizmo, int axis, const view::Camera& camera, const Eigen::Vector2d& pixel) {
  return nearest_on_ring(gizmo, axis, camera, kRingView_px, kRingViewHeight_px, pixel).distance_px;
}

RingDrag drag_from(int axis, const view::Camera& camera, const Eigen::Vector2d& pixel) {
  return {kRings, axis, camera, kRingView_px, kRingViewHeight_px, pixel};
}

void move(RingDrag& drag, const view::Camera& camera, const Eigen::Vector2d& pixel) {
  drag.move_to(camera, kRingView_px, kRingViewHeight_px, pixel);
}

// The share of the way from the centre to the eye at which the point is: positive in front of the centre.
double in_front(const view::Camera& camera, const Eigen::Vector3d& p_W_m) {
  return (p_W_m - kRings.p_W_m).normalized().dot((camera.eye_W_m() - kRings.p_W_m).normalized());
}

TEST(Ring, IsPickedWhereItFacesTheCamera) {
  int on_near_side = 0;
  for (const view::Camera& camera : ring_cameras())
    for (int axis = 0; axis < 3; ++axis)
      for (double angle_rad = 0.0; angle_rad < 2.0 * kPi; angle_rad += 0.1) {
        const Eigen::Vector3d p_W_m = on_ring_W_m(axis, angle_rad);
        const Eigen::Vector2d pixel = image_px(camera, p_W_m);
        const double from_ring_px = distance_px(kRings, axis, camera, pixel);
        if (in_front(camera, p_W_m) < 0.05) continue;
        ++on_near_side;
        EXPECT_LT(from_ring_px, 0.5);
        // The pixel picks this ring, or an arrow or ring that crosses it.
        const auto handle = picked(kRings, camera, pixel);
        const double from_centre_px = (pixel - image_px(camera, kRings.p_W_m)).norm();
        if (handle && handle->kind == Handle::Kind::kRing && handle->axis != axis) {
          EXPECT_LT(distance_px(kRings, handle->axis, camera, pixel), 1.0);
        } else if (!handle) {
          EXPECT_LT(from_centre_px, 0.36 * 100.0);
        }
      }
  EXPECT_GT(on_near_side, 1000);
}

TEST(Ring, LeavesTheBodyToTheMouse) {
  int picked_far = 0;
  for (const view::Camera& camera : ring_cameras()) {
    const Eigen::Vector2d centre_px = image_px(camera, kRings.p_W_m);
    EXPECT_FALSE(picked(kRings, camera, centre_px));
    const Gizmo arrows{kRings.p_W_m, kRings.length_m, false};
    for (double angle_rad = 0.0; angle_rad < 2.0 * kPi; angle_rad += 0.1) {
      const Eigen::Vector2d outside_px =
          centre_px + 120.0 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
      picked_far += picked(kRings, camera, outside_px) != picked(arrows, camera, outside_px) ? 1 : 0;
      // A body without rings has arrows only.
      const auto handle = picked(arrows, camera, image_px(camera, on_ring_W_m(2, angle_rad)));
      EXPECT_TRUE(!handle || handle->kind == Handle::Kind::kArrow);
    }
  }
  EXPECT_EQ(picked_far, 0);
  // The far side of a ring that is seen obliquely is neither shown nor picked.
  const view::Camera camera = ring_cameras()[10];
  const double far_rad =
      std::atan2(camera.eye_W_m().y() - kRings.p_W_m.y(), camera.eye_W_m().x() - kRings.p_W_m.x()) + kPi;
  const Eigen::Vector2d far_px = image_px(camera, on_ring_W_m(2, far_rad));
  EXPECT_GT(distance_px(kRings, 2, camera, far_px), 5.0);
}

// A body in front of a ring is grabbed instead; an arrow is drawn through the body, and picked there.
TEST(Ring, IsNotPickedBehindABody) {
  const view::Camera camera = ring_cameras()[10];
  const double near_rad =
      std::atan2(camera.eye_W_m().y() - kRings.p_W_m.y(), camera.eye_W_m().x() - kRings.p_W_m.x());
  const Eigen::Vector3d p_W_m = on_ring_W_m(2, near_rad + 0.3);
  const double from_eye_m = (camera.eye_W_m() - p_W_m).norm();
  const auto picked_before = [&](double surface_m) {
    return pick_handle(kRings, camera, kRingView_px, kRingViewHeight_px, image_px(camera, p_W_m), surface_m);
  };
  EXPECT_EQ(picked_before(from_eye_m + 0.02), (Handle{Handle::Kind::kRing, 2}));
  EXPECT_EQ(picked_before(from_eye_m), (Handle{Handle::Kind::kRing, 2}));
  EXPECT_FALSE(picked_before(from_eye_m - 0.02));
}

TEST(Ring, TurnsByTheAngleThatTheMouseSweeps) {
  int tried = 0;
  for (const view::Camera& camera : ring_cameras())
    for (int axis = 0; axis < 3; ++axis) {
      RingDrag drag = drag_from(axis, camera, image_px(camera, on_ring_W_m(axis, 0.4)));
      if (drag.is_edge_on()) continue;
      ++tried;
      EXPECT_EQ(drag.angle_rad(), 0.0);
      for (const double angle_rad : {0.3, -0.2, -1.1}) {
        move(drag, camera, image_px(camera, on_ring_W_m(axis, 0.4 + angle_rad)));
        EXPECT_NEAR(drag.angle_rad(), angle_rad, kSingle);
        EXPECT_NEAR(drag.rotation_W_rad()[axis], angle_rad, kSingle);
        EXPECT_NEAR(drag.rotation_W_rad().norm(), std::abs(angle_rad), kSingle);
      }
      // The distance from the centre does not matter.
      const Eigen::Vector3d arm_m = on_ring_W_m(axis, 1.0) - kRings.p_W_m;
      move(drag, camera, image_px(camera, kRings.p_W_m + 1.7 * arm_m));
      EXPECT_NEAR(drag.angle_rad(), 0.6, kSingle);
      // At the centre there is no direction.
      move(drag, camera, image_px(camera, kRings.p_W_m));
      EXPECT_NEAR(drag.angle_rad(), 0.6, kSingle);
    }
  EXPECT_GT(tried, 30);
}

TEST(Ring, CountsTurns) {
  const view::Camera camera = ring_cameras().back();
  for (const double end_rad : {5.0, -5.0, 14.0}) {
    RingDrag drag = drag_from(2, camera, image_px(camera, on_ring_W_m(2, 1.0)));
    for (int i = 1; i <= 20; ++i)
      move(drag, camera, image_px(camera, on_ring_W_m(2, 1.0 + end_rad * i / 20)));
    EXPECT_NEAR(drag.angle_rad(), end_rad, kSingle);
    for (int i = 20; i >= 0; --i)
      move(drag, camera, image_px(camera, on_ring_W_m(2, 1.0 + end_rad * i / 20)));
    EXPECT_NEAR(drag.angle_rad(), 0.0, kSingle);
  }
}

// A level camera sees the ring about z as a line: its near side follows the mouse to the right.
TEST(Ring, TurnsEdgeOnAlongItsImage) {
  for (const double azimuth_rad : {-2.0, 0.3, 1.9}) {
    const view::Camera camera = level_camera(azimuth_rad);
    const Eigen::Vector2d centre_px = image_px(camera, kRings.p_W_m);
    const double to_viewer_rad = azimuth_rad;  // of the near side, counted from x
    const double radius_px = (image_px(camera, on_ring_W_m(2, to_viewer_rad + 0.5 * kPi)) - centre_px).norm();
    RingDrag drag = drag_from(2, camera, centre_px + Eigen::Vector2d(40.0, 0.0));
    ASSERT_TRUE(drag.is_edge_on());
    move(drag, camera, centre_px + Eigen::Vector2d(40.0 + radius_px, 0.0));
    EXPECT_NEAR(drag.angle_rad(), 1.0, 0.02);
    // Across the line nothing turns; more than half a turn is possible.
    move(drag, camera, centre_px + Eigen::Vector2d(40.0, 70.0));
    EXPECT_NEAR(drag.angle_rad(), 0.0, 1e-3);
    move(drag, camera, centre_px + Eigen::Vector2d(40.0 - 4.0 * radius_px, 0.0));
    EXPECT_NEAR(drag.angle_rad(), -4.0, 0.08);
  }
}

// Both ways agree in sense and size where they meet, for small drags of the near side.
TEST(Ring, TurnsAlikeOnBothSidesOfTheFallBack) {
  view::Camera camera = level_camera(0.3);
  std::vector<double> angles_rad;
  for (const double elevation_rad : {0.19, 0.22}) {
    camera.elevation_rad = elevation_rad;
    const Eigen::Vector2d from_px = image_px(camera, on_ring_W_m(2, 0.3));
    RingDrag drag = drag_from(2, camera, from_px);
    EXPECT_EQ(drag.is_edge_on(), elevation_rad < 0.2);
    move(drag, camera, from_px + Eigen::Vector2d(8.0, 0.0));
    angles_rad.push_back(drag.angle_rad());
  }
  EXPECT_GT(angles_rad[0], 0.05);
  EXPECT_NEAR(angles_rad[0] / angles_rad[1], 1.0, 0.15);
}

TEST(Ring, IsMarkedInTheColourOfItsArrowAndChosenAlone) {
  const view::Camera camera = ring_cameras()[10];
  view::Marks arrows;
  view::Marks none;
  view::Marks chosen;
  add_gizmo(arrows, {kRings.p_W_m, kRings.length_m, false}, camera, std::nullopt);
  add_gizmo(none, kRings, camera, std::nullopt);
  add_gizmo(chosen, kRings, camera, Handle{Handle::Kind::kRing, 1});
  ASSERT_EQ(none.solid.size(), chosen.solid.size());
  ASSERT_GT(none.solid.size(), arrows.solid.size());
  const view::Colour green = gizmo_colour(1, false);
  const view::Colour yellow = gizmo_colour(1, true);
  for (std::size_t i = 0; i < none.solid.size(); ++i) {
    const bool is_ring_y = i >= arrows.solid.size() && none.solid[i].colour[1] == green.green;
    EXPECT_EQ(chosen.solid[i].colour[0], is_ring_y ? yellow.red : none.solid[i].colour[0]);
  }
  // Nearer and farther cameras show the same size: the radius follows the arrows.
  EXPECT_NEAR(Gizmo({{}, 2.0 * kRings.length_m, true}).ring_m(), 2.0 * kRings.ring_m(), 1e-12);
}

}  // namespace
}  // namespace koboshi::studio
