#include "tools/view/render/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace koboshi::view {
namespace {

// The side of a prism about z, in separate triangles as STL files have them.
Mesh prism(int sides) {
  Mesh mesh;
  const auto corner = [sides](int i, float z) {
    const float angle_rad =
        2.0F * std::numbers::pi_v<float> * static_cast<float>(i % sides) / static_cast<float>(sides);
    return Eigen::Vector3f(std::cos(angle_rad), std::sin(angle_rad), z);
  };
  for (int i = 0; i < sides; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const Eigen::Vector3f& p : {corner(i, 0.0F), corner(i + 1, 0.0F), corner(i + 1, 1.0F),
                                     corner(i, 0.0F), corner(i + 1, 1.0F), corner(i, 1.0F)})
      mesh.vertices_m.push_back(p);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 3, first + 4, first + 5});
  }
  return mesh;
}

float largest_error_of_radial_normals(const Surface& surface) {
  float largest = 0.0F;
  for (const Vertex& vertex : surface) {
    const Eigen::Vector3f radial = Eigen::Vector3f(vertex.p_m.x(), vertex.p_m.y(), 0.0F).normalized();
    largest = std::max(largest, (vertex.normal - radial).norm());
  }
  return largest;
}

TEST(SmoothSurface, IsSmoothOverEdgesOfFewDegrees) {
  const Surface surface = smooth_surface(prism(24));
  ASSERT_EQ(surface.size(), 24U * 6U);
  EXPECT_LT(largest_error_of_radial_normals(surface), 1e-4F);
}

TEST(SmoothSurface, KeepsSharpEdges) {
  const Surface surface = smooth_surface(prism(4));  // 90 degrees between sides
  for (std::size_t i = 0; i < surface.size(); i += 3) {
    const Eigen::Vector3f face =
        (surface[i + 1].p_m - surface[i].p_m).cross(surface[i + 2].p_m - surface[i].p_m).normalized();
    for (std::size_t corner = i; corner < i + 3; ++corner)
      EXPECT_LT((surface[corner].normal - face).norm(), 1e-5F);
  }
}

TEST(SmoothSurface, DropsTrianglesWithoutArea) {
  Mesh mesh = prism(8);
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(smooth_surface(mesh).size(), 8U * 6U);
}

TEST(BoxSurface, HasItsSizeAndOutwardNormals) {
  const Surface surface = box_surface({0.2, 0.4, 0.6});
  ASSERT_EQ(surface.size(), 36U);
  double area_m2 = 0.0;
  for (std::size_t i = 0; i < surface.size(); i += 3) {
    const Eigen::Vector3f twice =
        (surface[i + 1].p_m - surface[i].p_m).cross(surface[i + 2].p_m - surface[i].p_m);
    EXPECT_GT(twice.dot(surface[i].normal), 0.0F) << "counter-clockwise from outside";
    EXPECT_GT(surface[i].p_m.dot(surface[i].normal), 0.0F);
    area_m2 += 0.5 * static_cast<double>(twice.norm());
  }
  EXPECT_NEAR(area_m2, 2.0 * (0.08 + 0.24 + 0.12), 1e-6);
  EXPECT_NEAR(static_cast<double>(radius_m(surface)), 0.5 * std::hypot(0.2, 0.4, 0.6), 1e-6);
}

}  // namespace
}  // namespace koboshi::view
