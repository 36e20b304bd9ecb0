#include "studio/view/picking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace koboshi::studio {
namespace {

// A box of 0.2 m about the origin, and 1 m behind it, seen along x, a triangle that faces the viewer.
view::Scene scene() {
  view::Scene scene;
  scene.links.resize(2);
  view::Shape box;
  box.geometry = view::Box{{0.2, 0.2, 0.2}};
  scene.links[0].visuals = {box};
  view::Mesh mesh;
  mesh.vertices_m = {{0.0F, -1.0F, -1.0F}, {0.0F, 1.0F, -1.0F}, {0.0F, 0.0F, 1.0F}};
  mesh.triangles = {{0, 1, 2}};
  view::Shape triangle;
  triangle.geometry = mesh;
  scene.links[1].visuals = {triangle};
  return scene;
}

std::vector<view::Pose> poses() {
  std::vector<view::Pose> links(2);
  links[1].p_WL_m = {-1.0F, 0.0F, 0.0F};
  return links;
}

Ray along_x(double y_m, double z_m) { return {{2.0, y_m, z_m}, -Eigen::Vector3d::UnitX()}; }

TEST(Picker, FindsTheNearestSurface) {
  const view::Scene shapes = scene();
  const auto hit = Picker(shapes).pick(poses(), along_x(0.05, 0.02));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->link, 0);
  EXPECT_NEAR(hit->distance_m, 1.9, 1e-9);
  EXPECT_TRUE(hit->p_L_m.isApprox(Eigen::Vector3d(0.1, 0.05, 0.02), 1e-9));
}

TEST(Picker, FindsWhatIsBehindBesideTheFirst) {
  const view::Scene shapes = scene();
  const auto hit = Picker(shapes).pick(poses(), along_x(0.3, 0.0));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->link, 1);
  EXPECT_NEAR(hit->distance_m, 3.0, 1e-6);
}

TEST(Picker, FindsNothingOutsideATriangleWithinItsBounds) {
  const view::Scene shapes = scene();
  EXPECT_FALSE(Picker(shapes).pick(poses(), along_x(0.9, 0.9)));
}

TEST(Picker, FollowsThePoseOfALink) {
  const view::Scene shapes = scene();
  std::vector<view::Pose> links = poses();
  links[0].p_WL_m = {0.0F, 0.5F, 0.0F};
  links[0].q_WL = Eigen::Quaternionf(Eigen::AngleAxisf(0.7853982F, Eigen::Vector3f::UnitZ()));
  const auto hit = Picker(shapes).pick(links, along_x(0.5, 0.0));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->link, 0);
  EXPECT_NEAR(hit->distance_m, 2.0 - 0.1 * 1.41421356, 1e-6);  // the edge comes first
}

TEST(Picker, IgnoresWhatLiesBehindTheViewer) {
  const view::Scene shapes = scene();
  EXPECT_FALSE(Picker(shapes).pick(poses(), {{2.0, 0.0, 0.0}, Eigen::Vector3d::UnitX()}));
}

// The box of scene(), seen along -x from 2 m: the pixel that shows its left edge.
TEST(Picker, ANearMissFindsTheNearestLink) {
  constexpr int kWidth_px = 800;
  constexpr int kHeight_px = 600;
  const view::Scene shapes = scene();
  const Picker picker(shapes);
  view::Camera camera;
  camera.distance_m = 2.0;
  const auto box_only = [](int link) { return link == 0; };
  const Eigen::Vector2d edge_px = view::project(camera, kWidth_px, kHeight_px, {0.1, 0.1, 0.0});
  const auto near = [&](double beside_px, const std::function<bool(int)>& accepts) {
    const double outwards = edge_px.x() > 0.5 * kWidth_px ? beside_px : -beside_px;
    return pick_near(picker, poses(), camera, kWidth_px, kHeight_px, edge_px + Eigen::Vector2d(outwards, 0.0),
                     accepts);
  };
  for (const double beside_px : {-3.0, 0.5, 4.0, 7.5}) {
    const auto found = near(beside_px, box_only);
    ASSERT_TRUE(found) << beside_px;
    EXPECT_EQ(found->hit.link, 0);
    EXPECT_GE(found->distance_px, std::max(0.0, beside_px));
    EXPECT_LE(found->distance_px, std::max(0.0, beside_px) + kNear_px / 3.0);
  }
  EXPECT_FALSE(near(kNear_px + 1.0, box_only));
  // The link under the pixel comes before one beside it.
  const auto behind = near(4.0, [](int) { return true; });
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->hit.link, 1);
  EXPECT_EQ(behind->distance_px, 0.0);
}

}  // namespace
}  // namespace koboshi::studio
