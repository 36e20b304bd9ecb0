#include "studio/view/picking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

namespace koboshi::studio {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

// Distance along a ray to a box, by the slab method (Kay and Kajiya 1986).
double distance_to(const Eigen::AlignedBox3d& box, const Ray& ray) {
  double enters = 0.0;
  double leaves = kNowhere;
  for (int axis = 0; axis < 3; ++axis) {
    const double speed = ray.direction_W[axis];
    const double low_m = box.min()[axis] - ray.origin_W_m[axis];
    const double high_m = box.max()[axis] - ray.origin_W_m[axis];
    if (speed == 0.0) {
      if (low_m > 0.0 || high_m < 0.0) return kNowhere;
      continue;
    }
    const auto [first, second] = std::minmax({low_m / speed, high_m / speed});
    enters = std::max(enters, first);
    leaves = std::min(leaves, second);
  }
  return enters <= leaves ? enters : kNowhere;
}

// Möller and Trumbore 1997.
double distance_to_triangle(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                            const Eigen::Vector3d& c_m, const Ray& ray) {
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
  double nearest_m = kNowhere;
  for (const auto& [a, b, c] : mesh.triangles)
    nearest_m = std::min(
        nearest_m, distance_to_triangle(mesh.vertices_m[a].cast<double>(), mesh.vertices_m[b].cast<double>(),
                                        mesh.vertices_m[c].cast<double>(), ray));
  return nearest_m;
}

Eigen::AlignedBox3d bounds_of(const view::Shape& shape) {
  Eigen::AlignedBox3d bounds;
  if (const auto* box = std::get_if<view::Box>(&shape.geometry)) {
    bounds.extend(Eigen::Vector3d(0.5 * box->size_m));
    bounds.extend(Eigen::Vector3d(-0.5 * box->size_m));
  } else {
    for (const Eigen::Vector3f& vertex : std::get<view::Mesh>(shape.geometry).vertices_m)
      bounds.extend(vertex.cast<double>());
  }
  return bounds;
}

Ray transformed(const Eigen::Isometry3d& transform, const Ray& ray) {
  return {transform * ray.origin_W_m, transform.linear() * ray.direction_W};
}

}  // namespace

Picker::Picker(const view::Scene& scene) {
  for (std::size_t link = 0; link < scene.links.size(); ++link)
    for (const view::Shape& shape : scene.links[link].visuals)
      targets_.push_back({&shape, static_cast<int>(link), bounds_of(shape)});
}

std::optional<Hit> Picker::pick(std::span<const view::Pose> links, const Ray& ray) const {
  std::optional<Hit> nearest;
  for (const Target& target : targets_) {
    const auto link = static_cast<std::size_t>(target.link);
    if (link >= links.size() || target.bounds.isEmpty()) continue;
    Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
    X_WL.linear() = links[link].q_WL.cast<double>().normalized().toRotationMatrix();
    X_WL.translation() = links[link].p_WL_m.cast<double>();
    const Ray ray_L = transformed(X_WL.inverse(), ray);
    const Ray ray_G = transformed(target.shape->X_LG.inverse(), ray_L);
    double distance_m = distance_to(target.bounds, ray_G);
    if (distance_m >= (nearest ? nearest->distance_m : kNowhere)) continue;
    if (const auto* mesh = std::get_if<view::Mesh>(&target.shape->geometry))
      distance_m = distance_to(*mesh, ray_G);
    if (distance_m >= (nearest ? nearest->distance_m : kNowhere)) continue;
    nearest = {target.link, distance_m, ray_L.origin_W_m + distance_m * ray_L.direction_W};
  }
  return nearest;
}

// Looks along circles about the pixel; the first that meets an accepted link decides.
std::optional<NearHit> pick_near(const Picker& picker, std::span<const view::Pose> links,
                                 const view::Camera& camera, int width_px, int height_px,
                                 const Eigen::Vector2d& pixel, const std::function<bool(int link)>& accepts) {
  constexpr int kCircles = 3;
  constexpr int kPlaces = 8;  // on the innermost circle, and more on each further one
  for (int circle = 0; circle <= kCircles; ++circle) {
    const double radius_px = kNear_px * circle / kCircles;
    const int places = std::max(1, kPlaces * circle);
    for (int i = 0; i < places; ++i) {
      const double angle_rad = 2.0 * std::numbers::pi * i / places;
      const Eigen::Vector2d beside =
          pixel + radius_px * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
      const auto hit = picker.pick(links, ray_through(camera, width_px, height_px, beside));
      if (hit && accepts(hit->link)) return NearHit{*hit, radius_px};
    }
  }
  return std::nullopt;
}

}  // namespace koboshi::studio
