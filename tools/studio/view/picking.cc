#include "tools/studio/view/picking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <variant>

namespace koboshi::studio {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

// Distances along a ray to a box about the origin, by the slab method (Kay and Kajiya 1986).
double distance_to(const view::Box& box, const Ray& ray) {
  double enters = 0.0;
  double leaves = kNowhere;
  for (int axis = 0; axis < 3; ++axis) {
    const double half_m = 0.5 * box.size_m[axis];
    const double speed = ray.direction_W[axis];
    const double place_m = ray.origin_W_m[axis];
    if (speed == 0.0) {
      if (std::abs(place_m) > half_m) return kNowhere;
      continue;
    }
    auto [first, second] = std::minmax((-half_m - place_m) / speed, (half_m - place_m) / speed);
    enters = std::max(enters, first);
    leaves = std::min(leaves, second);
  }
  return enters <= leaves ? enters : kNowhere;
}

// Möller and Trumbore 1997.
double distance_to_triangle(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m,
                            const Ray& ray) {
  const Eigen::Vector3d ab = b_m - a_m;
  const Eigen::Vector3d ac = c_m - a_m;
  const Eigen::Vector3d p = ray.direction_W.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return kNowhere;
  const Eigen::Vector3d t = ray.origin_W_m - a_m;
  const double u = t.dot(p) / determinant;
  const Eigen::Vector3d q = t.cross(ab);
  const double v = ray.direction_W.dot(q) / determinant;
  const double distance_m = ac.dot(q) / determinant;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance_m >= 0.0 ? distance_m : kNowhere;
}

double distance_to(const view::Mesh& mesh, const Ray& ray) {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) bounds.extend(vertex.cast<double>());
  if (bounds.isEmpty()) return kNowhere;
  const Ray from_centre{ray.origin_W_m - bounds.center(), ray.direction_W};
  if (distance_to(view::Box{bounds.sizes()}, from_centre) == kNowhere) return kNowhere;
  double nearest_m = kNowhere;
  for (const auto& [a, b, c] : mesh.triangles)
    nearest_m = std::min(nearest_m, distance_to_triangle(mesh.vertices_m[a].cast<double>(), mesh.vertices_m[b].cast<double>(),
                                                         mesh.vertices_m[c].cast<double>(), ray));
  return nearest_m;
}

Ray transformed(const Eigen::Isometry3d& transform, const Ray& ray) {
  return {transform * ray.origin_W_m, transform.linear() * ray.direction_W};
}

}  // namespace

std::optional<Hit> pick(const view::Scene& scene, std::span<const view::Pose> links, const Ray& ray) {
  std::optional<Hit> nearest;
  for (std::size_t i = 0; i < std::min(scene.links.size(), links.size()); ++i) {
    Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
    X_WL.linear() = links[i].q_WL.cast<double>().normalized().toRotationMatrix();
    X_WL.translation() = links[i].p_WL_m.cast<double>();
    const Ray ray_L = transformed(X_WL.inverse(), ray);
    for (const view::Shape& shape : scene.links[i].visuals) {
      const Ray ray_G = transformed(shape.X_LG.inverse(), ray_L);
      const double distance_m = std::visit([&](const auto& geometry) { return distance_to(geometry, ray_G); }, shape.geometry);
      if (distance_m == kNowhere || (nearest && nearest->distance_m <= distance_m)) continue;
      nearest = {static_cast<int>(i), distance_m, ray_L.origin_W_m + distance_m * ray_L.direction_W};
    }
  }
  return nearest;
}

}  // namespace koboshi::studio
