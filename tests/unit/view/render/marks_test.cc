#include "view/render/marks.h"
#include "view/render/tint.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace koboshi::view {
namespace {

constexpr Colour kRed{1.0F, 0.0F, 0.0F};

double area_m2(const std::vector<MarkVertex>& vertices) {
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    const Eigen::Vector3f a = vertices[i + 1].p_W_m - vertices[i].p_W_m;
    const Eigen::Vector3f b = vertices[i + 2].p_W_m - vertices[i].p_W_m;
    sum_m2 += 0.5 * static_cast<double>(a.cross(b).norm());
  }
  return sum_m2;
}

TEST(Marks, ArrowReachesFromTailToTip) {
  for (const double length_m : {0.004, 0.05, 0.3}) {  // the first is shorter than a head
    Marks marks;
    const Eigen::Vector3d along = Eigen::Vector3d(1.0, -2.0, 2.0) / 3.0;
    add_arrow(marks, {1.0, 1.0, 1.0}, Eigen::Vector3d(1.0, 1.0, 1.0) + length_m * along, 0.002, kRed);
    double first_m = 1.0;
    double last_m = -1.0;
    for (const MarkVertex& vertex : marks.solid) {
      const double at_m = (vertex.p_W_m.cast<double>() - Eigen::Vector3d(1.0, 1.0, 1.0)).dot(along);
      first_m = std::min(first_m, at_m);
      last_m = std::max(last_m, at_m);
    }
    EXPECT_NEAR(first_m, 0.0, 1e-5) << length_m;
    EXPECT_NEAR(last_m, length_m, 1e-5) << length_m;
  }
}

TEST(Marks, ArrowWithoutLengthIsNothing) {
  Marks marks;
  add_arrow(marks, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, 0.002, kRed);
  EXPECT_TRUE(marks.solid.empty());
}

TEST(Marks, SphereHasItsAreaAndNormals) {
  Marks marks;
  const Eigen::Vector3d centre_m(0.3, 0.2, 0.1);
  add_sphere(marks, centre_m, 0.05, kRed);
  EXPECT_NEAR(area_m2(marks.solid) / (4.0 * std::numbers::pi * 0.05 * 0.05), 1.0, 0.03);
  for (const MarkVertex& vertex : marks.solid) {
    const Eigen::Vector3f outwards = (vertex.p_W_m - centre_m.cast<float>()) / 0.05F;
    EXPECT_LT((vertex.normal - outwards).norm(), 1e-4F);
  }
}

TEST(Marks, RingAndPolygonHaveTheirAreas) {
  Marks ring;
  add_disc(ring, {0.0, 0.0, 0.0}, 0.02, 0.01, kRed, 0.5);
  EXPECT_NEAR(area_m2(ring.flat) / (std::numbers::pi * (4e-4 - 1e-4)), 1.0, 0.02);
  Marks square;
  const std::vector<Eigen::Vector3d> corners_m{{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
  add_polygon(square, corners_m, kRed, 1.0);
  EXPECT_NEAR(area_m2(square.flat), 0.01, 1e-8);
}

TEST(Marks, LineIsClosedOnlyIfAskedFor) {
  const std::vector<Eigen::Vector3d> corners_m{{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
  Marks open;
  Marks closed;
  add_line(open, corners_m, 0.002, false, kRed, 1.0);
  add_line(closed, corners_m, 0.002, true, kRed, 1.0);
  EXPECT_NEAR(area_m2(open.flat), 3 * 0.1 * 0.002, 1e-8);
  EXPECT_NEAR(area_m2(closed.flat), 4 * 0.1 * 0.002, 1e-8);
}

TEST(Tint, IsMixedInLinearLight) {
  EXPECT_LT((linear_light({1.0F, 0.0F, 0.04045F}) - Eigen::Vector3f(1.0F, 0.0F, 0.04045F / 12.92F)).norm(),
            1e-6F);
  EXPECT_NEAR(linear_light({0.5F, 0.5F, 0.5F}).x(), 0.2140F, 1e-4F) << "IEC 61966-2-1";
  const Tint half{.colour = {1.0F, 1.0F, 1.0F}, .share = 0.5F};
  EXPECT_LT((linear_light({}, half) - Eigen::Vector3f::Constant(0.5F)).norm(), 1e-6F);
  EXPECT_EQ(linear_light({0.2F, 0.4F, 0.6F}, Tint()), linear_light({0.2F, 0.4F, 0.6F}));
}

}  // namespace
}  // namespace koboshi::view
