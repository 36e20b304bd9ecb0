#include "view/render/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

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
  for (const Vertex& vertex : surface.vertices) {
    const Eigen::Vector3f radial = Eigen::Vector3f(vertex.p_m.x(), vertex.p_m.y(), 0.0F).normalized();
    largest = std::max(largest, (vertex.normal - radial).norm());
  }
  return largest;
}

TEST(SmoothSurface, IsSmoothOverEdgesOfFewDegrees) {
  const Surface surface = smooth_surface(prism(24));
  EXPECT_EQ(surface.triangles.size(), 24U * 2U);
  EXPECT_EQ(surface.vertices.size(), 24U * 2U);  // neighbouring sides share them
  EXPECT_LT(largest_error_of_radial_normals(surface), 1e-4F);
}

// The normal of a triangle, twice as long as its area.
Eigen::Vector3f twice_area(const Surface& surface, std::size_t triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  const Eigen::Vector3f& origin = surface.vertices[a].p_m;
  return (surface.vertices[b].p_m - origin).cross(surface.vertices[c].p_m - origin);
}

TEST(SmoothSurface, KeepsSharpEdges) {
  const Surface surface = smooth_surface(prism(4));  // 90 degrees between sides
  EXPECT_EQ(surface.vertices.size(), 4U * 4U);       // four for each side
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    for (const std::uint32_t corner : surface.triangles[i])
      EXPECT_LT((surface.vertices[corner].normal - twice_area(surface, i).normalized()).norm(), 1e-5F);
}

TEST(SmoothSurface, DropsTrianglesWithoutArea) {
  Mesh mesh = prism(8);
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(smooth_surface(mesh).triangles.size(), 8U * 2U);
}

Mesh tetrahedron() {
  return {.vertices_m = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}},
          .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(SmoothSurface, IsClosedWhereEveryEdgeJoinsTwoTriangles) {
  EXPECT_TRUE(smooth_surface(tetrahedron()).closed);
  Mesh open = tetrahedron();
  open.triangles.pop_back();
  EXPECT_FALSE(smooth_surface(open).closed);
  EXPECT_FALSE(smooth_surface(prism(8)).closed) << "it has neither bottom nor top";
}

// Its fronts would be hidden, and what is behind them seen.
TEST(SmoothSurface, IsNotClosedIfItFacesInwards) {
  Mesh inwards = tetrahedron();
  for (auto& triangle : inwards.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_FALSE(smooth_surface(inwards).closed);
  Mesh one_inwards = tetrahedron();
  std::swap(one_inwards.triangles[2][0], one_inwards.triangles[2][1]);
  EXPECT_FALSE(smooth_surface(one_inwards).closed);
}

TEST(BoxSurface, HasItsSizeAndOutwardNormals) {
  const Surface surface = box_surface({0.2, 0.4, 0.6});
  ASSERT_EQ(surface.vertices.size(), 24U);
  ASSERT_EQ(surface.triangles.size(), 12U);
  EXPECT_TRUE(surface.closed);
  double area_m2 = 0.0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Eigen::Vector3f twice = twice_area(surface, i);
    const Vertex& corner = surface.vertices[surface.triangles[i].front()];
    EXPECT_GT(twice.dot(corner.normal), 0.0F) << "counter-clockwise from outside";
    EXPECT_GT(corner.p_m.dot(corner.normal), 0.0F);
    area_m2 += 0.5 * static_cast<double>(twice.norm());
  }
  EXPECT_NEAR(area_m2, 2.0 * (0.08 + 0.24 + 0.12), 1e-6);
  EXPECT_NEAR(static_cast<double>(radius_m(surface)), 0.5 * std::hypot(0.2, 0.4, 0.6), 1e-6);
}

}  // namespace
}  // namespace koboshi::view
