#include "studio/view/gizmo.h"

#include <gtest/gtest.h>

namespace koboshi::studio {
namespace {

constexpr int kView_px = 800;
constexpr int kViewHeight_px = 600;

view::Camera gizmo_camera() {
  view::Camera camera;
  camera.azimuth_rad = 0.8;
  camera.elevation_rad = 0.3;
  return camera;
}

TEST(Gizmo, PicksTheAxisUnderTheMouse) {
  const Gizmo gizmo{{0.05, 0.02, 0.1}, 0.15};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d on_W_m = gizmo.p_W_m + 0.8 * gizmo.length_m * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector2d place_px = view::project(gizmo_camera(), kView_px, kViewHeight_px, on_W_m);
    EXPECT_EQ(pick_handle(gizmo, gizmo_camera(), kView_px, kViewHeight_px, place_px),
              (Handle{Handle::Kind::kArrow, axis}));
  }
  const Eigen::Vector2d origin_px = view::project(gizmo_camera(), kView_px, kViewHeight_px, gizmo.p_W_m);
  EXPECT_FALSE(pick_handle(gizmo, gizmo_camera(), kView_px, kViewHeight_px, origin_px));
}

TEST(Gizmo, MovesAlongTheAxisByTheImageOfTheDrag) {
  const Gizmo gizmo{{0.05, 0.02, 0.1}, 0.15};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d tip_W_m = gizmo.p_W_m + gizmo.length_m * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector2d arrow_px = view::project(gizmo_camera(), kView_px, kViewHeight_px, tip_W_m) -
                                     view::project(gizmo_camera(), kView_px, kViewHeight_px, gizmo.p_W_m);
    const Eigen::Vector3d moved =
        along_axis_W_m(gizmo, axis, gizmo_camera(), kView_px, kViewHeight_px, 0.5 * arrow_px);
    EXPECT_LT((moved - 0.5 * gizmo.length_m * Eigen::Vector3d::Unit(axis)).norm(), 1e-9);
    const Eigen::Vector2d across_px(-arrow_px.y(), arrow_px.x());
    EXPECT_LT(along_axis_W_m(gizmo, axis, gizmo_camera(), kView_px, kViewHeight_px, across_px).norm(), 1e-9);
  }
}

TEST(Gizmo, MarksTheChosenAxis) {
  view::Marks none;
  view::Marks chosen;
  add_gizmo(none, {}, gizmo_camera(), std::nullopt);
  add_gizmo(chosen, {}, gizmo_camera(), Handle{Handle::Kind::kArrow, 1});
  ASSERT_EQ(none.solid.size(), chosen.solid.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < none.solid.size(); ++i)
    differing += none.solid[i].colour != chosen.solid[i].colour ? 1U : 0U;
  EXPECT_EQ(differing, none.solid.size() / 3);
}

}  // namespace
}  // namespace koboshi::studio
