#include "tools/import/mesh/primitives.h"

#include <cmath>
#include <numbers>

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kSides = 24;  // of a circle

view::Mesh box(const Vector3d& size_m) {
  view::Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                        (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices_m.push_back(sign.cwiseProduct(size_m).cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// A body of revolution about z through rings of these radii and heights, from below; closed by its poles.
struct Ring {
  double radius_m;
  double z_m;
};
view::Mesh revolve(const std::vector<Ring>& rings) {
  view::Mesh mesh;
  mesh.vertices_m.emplace_back(Vector3d(0.0, 0.0, rings.front().z_m).cast<float>());
  for (const Ring& ring : rings) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSides;
      mesh.vertices_m.emplace_back(
          Vector3d(ring.radius_m * std::cos(angle), ring.radius_m * std::sin(angle), ring.z_m).cast<float>());
    }
  }
  mesh.vertices_m.emplace_back(Vector3d(0.0, 0.0, rings.back().z_m).cast<float>());
  const auto last = static_cast<std::uint32_t>(mesh.vertices_m.size() - 1);
  const auto count = static_cast<std::uint32_t>(rings.size());
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t next = (i + 1) % kSides;
    mesh.triangles.push_back({0, 1 + next, 1 + i});
    for (std::uint32_t ring = 0; ring + 1 < count; ++ring) {
      const std::uint32_t below = 1 + ring * kSides;
      const std::uint32_t above = below + kSides;
      mesh.triangles.push_back({below + i, below + next, above + i});
      mesh.triangles.push_back({below + next, above + next, above + i});
    }
    const std::uint32_t top = 1 + (count - 1) * kSides;
    mesh.triangles.push_back({last, top + i, top + next});
  }
  return mesh;
}

// A sphere whose halves are `straight_m` apart.
view::Mesh capsule(double radius_m, double straight_m) {
  constexpr int kRings = 6;  // from the equator to a pole
  std::vector<Ring> rings;
  for (int i = -kRings; i <= kRings; ++i) {
    if (std::abs(i) == kRings) continue;  // the poles are added by revolve()
    const double latitude = 0.5 * std::numbers::pi * i / kRings;
    const double z_m = radius_m * std::sin(latitude);
    if (i <= 0) rings.push_back({radius_m * std::cos(latitude), z_m - 0.5 * straight_m});
    if (i >= 0 && (i > 0 || straight_m > 0.0))
      rings.push_back({radius_m * std::cos(latitude), z_m + 0.5 * straight_m});
  }
  view::Mesh mesh = revolve(rings);
  mesh.vertices_m.front().z() = static_cast<float>(-radius_m - 0.5 * straight_m);
  mesh.vertices_m.back().z() = static_cast<float>(radius_m + 0.5 * straight_m);
  return mesh;
}

view::Mesh surface_of(ShapeKind kind, const Vector3d& size_m) {
  switch (kind) {
    case ShapeKind::kCylinder:
      return revolve({{size_m.x(), -0.5 * size_m.z()}, {size_m.x(), 0.5 * size_m.z()}});
    case ShapeKind::kSphere:
      return capsule(size_m.x(), 0.0);
    case ShapeKind::kCapsule:
      return capsule(size_m.x(), size_m.z());
    default:
      return box(size_m);
  }
}

}  // namespace

std::shared_ptr<const view::Mesh> primitive_surface(ShapeKind kind, const Vector3d& size_m) {
  return std::make_shared<const view::Mesh>(surface_of(kind, size_m));
}

}  // namespace koboshi::tools
