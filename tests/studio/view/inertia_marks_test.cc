#include "studio/view/inertia_marks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_board/description/load.h"

namespace koboshi::studio {
namespace {

// A uniform ellipsoid has its own moments again.
TEST(InertiaEllipsoids, HaveMassAndMomentsOfTheirLinks) {
  const sim_board::RobotDescription robot =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  const auto ellipsoids = inertia_ellipsoids(robot);
  ASSERT_EQ(ellipsoids.size(), robot.links.size());
  for (const InertiaEllipsoid& ellipsoid : ellipsoids) {
    const sim_board::LinkDescription& link = robot.links[static_cast<std::size_t>(ellipsoid.link)];
    const Eigen::Vector3d squares_m2 = ellipsoid.radii_m.cwiseAbs2();
    const Eigen::Vector3d moments =
        link.mass_kg / 5.0 * (Eigen::Vector3d::Constant(squares_m2.sum()) - squares_m2);
    const Eigen::Matrix3d axes = ellipsoid.X_LE.linear();
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
    EXPECT_LT((axes * moments.asDiagonal() * axes.transpose() - link.I_LCom_L).norm(),
              1e-9 * link.I_LCom_L.norm())
        << link.name;
    EXPECT_EQ(ellipsoid.X_LE.translation(), link.p_LCom_L);
  }
}

TEST(InertiaEllipsoids, AreDrawnAroundTheCentreOfMass) {
  const InertiaEllipsoid ellipsoid{.link = 1,
                                   .X_LE = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.1)),
                                   .radii_m = {0.03, 0.02, 0.01}};
  std::vector<view::Pose> links(2);
  links[1].p_WL_m = {1.0F, 0.0F, 0.0F};
  view::Marks marks;
  add_inertia_ellipsoids(marks, links, std::vector{ellipsoid});
  ASSERT_FALSE(marks.solid.empty());
  Eigen::AlignedBox3f box;
  for (const view::MarkVertex& vertex : marks.solid) box.extend(vertex.p_W_m);
  EXPECT_LT((box.center() - Eigen::Vector3f(1.0F, 0.0F, 0.1F)).norm(), 1e-3F);
  EXPECT_LT((box.sizes() - Eigen::Vector3f(0.06F, 0.04F, 0.02F)).norm(), 4e-3F);
}

}  // namespace
}  // namespace koboshi::studio
