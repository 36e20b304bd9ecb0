#include "studio/view/ring.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "studio/view/camera_control.h"

namespace koboshi::studio {
namespace {

constexpr int kSegments = 64;         // of a ring
constexpr int kTubeSides = 6;         // of a ring's cross-section
constexpr double kTube = 0.012;       // its radius, as a share of an arrow's length: thinner than the arrows
constexpr double kBehind = 0.1;       // share of the radius by which a shown point may lie behind the centre
constexpr double kSpoke = 0.014;      // radius of a spoke, as a share of an arrow's length
constexpr double kNoDirection = 0.1;  // share of the radius around the centre without a direction
constexpr double kEdgeOn = 0.2;       // sine of the angle between the line of sight and the ring's plane

// The directions in the plane of a ring: (u, v, axis) is right-handed.
Eigen::Vector3d ring_u(int axis) { return Eigen::Vector3d::Unit((axis + 1) % 3); }
Eigen::Vector3d ring_v(int axis) { return Eigen::Vector3d::Unit((axis + 2) % 3); }
Eigen::Vector3d radial(int axis, double angle_rad) {
  return std::cos(angle_rad) * ring_u(axis) + std::sin(angle_rad) * ring_v(axis);
}
Eigen::Vector3d radial_of(int axis, int segment) {
  return radial(axis, 2.0 * std::numbers::pi * segment / kSegments);
}

Eigen::Vector3d to_eye(const Gizmo& gizmo, const view::Camera& camera) {
  return (camera.eye_W_m() - gizmo.p_W_m).normalized();
}

// Whether the middle of a segment is shown.
bool is_shown(int axis, int segment, const Eigen::Vector3d& to_eye) {
  return radial(axis, 2.0 * std::numbers::pi * (segment + 0.5) / kSegments).dot(to_eye) > -kBehind;
}

void add_tube(std::vector<view::MarkVertex>& out, const Gizmo& gizmo, int axis, int segment,
              const std::array<float, 4>& colour) {
  const auto vertex = [&](int at, int side) {
    const double angle_rad = 2.0 * std::numbers::pi * side / kTubeSides;
    const Eigen::Vector3d normal =
        std::cos(angle_rad) * radial_of(axis, at) + std::sin(angle_rad) * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d p_m =
        gizmo.p_W_m + gizmo.ring_m() * radial_of(axis, at) + kTube * gizmo.length_m * normal;
    return view::MarkVertex{p_m.cast<float>(), normal.cast<float>(), colour};
  };
  for (int side = 0; side < kTubeSides; ++side) {
    const view::MarkVertex a = vertex(segment, side);
    const view::MarkVertex b = vertex(segment + 1, side);
    const view::MarkVertex c = vertex(segment + 1, side + 1);
    const view::MarkVertex d = vertex(segment, side + 1);
    out.insert(out.end(), {a, b, c, a, c, d});
  }
}

}  // namespace

RingPoint nearest_on_ring(const Gizmo& gizmo, int axis, const view::Camera& camera, int width_px,
                          int height_px, const Eigen::Vector2d& pixel) {
  const Eigen::Vector3d eye = to_eye(gizmo, camera);
  const auto point_W_m = [&](int segment) -> Eigen::Vector3d {
    return gizmo.p_W_m + gizmo.ring_m() * radial_of(axis, segment);
  };
  const auto image = [&](int segment) {
    return view::project(camera, width_px, height_px, point_W_m(segment));
  };
  RingPoint nearest{.distance_px = std::numeric_limits<double>::infinity()};
  for (int segment = 0; segment < kSegments; ++segment) {
    if (!is_shown(axis, segment, eye)) continue;
    const Eigen::Vector2d from_px = image(segment);
    const Eigen::Vector2d along_px = image(segment + 1) - from_px;
    const double length2 = along_px.squaredNorm();
    const double share =
        length2 > 0.0 ? std::clamp((pixel - from_px).dot(along_px) / length2, 0.0, 1.0) : 0.0;
    const double distance_px = (from_px + share * along_px - pixel).norm();
    if (distance_px < nearest.distance_px)
      nearest = {distance_px, (camera.eye_W_m() - point_W_m(segment)).norm()};
  }
  return nearest;
}

void add_ring(view::Marks& marks, const Gizmo& gizmo, int axis, const view::Camera& camera, bool entire,
              const view::Colour& colour) {
  const Eigen::Vector3d eye = to_eye(gizmo, camera);
  for (int segment = 0; segment < kSegments; ++segment)
    if (entire || is_shown(axis, segment, eye))
      add_tube(marks.solid, gizmo, axis, segment, {colour.red, colour.green, colour.blue, 1.0F});
}

RingDrag::RingDrag(const Gizmo& gizmo, int axis, const view::Camera& camera, int width_px, int height_px,
                   const Eigen::Vector2d& pixel)
    : gizmo_(gizmo), axis_(axis), start_px_(pixel) {
  Eigen::Vector3d near = to_eye(gizmo, camera);
  is_edge_on_ = std::abs(near[axis]) < kEdgeOn;
  const std::optional<double> direction = direction_rad(camera, width_px, height_px, pixel);
  if (direction && !is_edge_on_) start_rad_ = *direction;
  if (!is_edge_on_) return;
  near[axis] = 0.0;
  near.normalize();
  start_rad_ = std::atan2(near.dot(ring_v(axis)), near.dot(ring_u(axis)));
  const Eigen::Vector3d tangent = gizmo.ring_m() * Eigen::Vector3d::Unit(axis).cross(near);
  tangent_px_ = view::project(camera, width_px, height_px, gizmo.p_W_m + tangent) -
                view::project(camera, width_px, height_px, gizmo.p_W_m);
}

std::optional<double> RingDrag::direction_rad(const view::Camera& camera, int width_px, int height_px,
                                              const Eigen::Vector2d& pixel) const {
  const Ray ray = ray_through(camera, width_px, height_px, pixel);
  const double way_m = (gizmo_.p_W_m - ray.origin_W_m)[axis_] / ray.direction_W[axis_];
  if (!std::isfinite(way_m) || way_m <= 0.0) return std::nullopt;  // the plane is not under the pixel
  const Eigen::Vector3d arm_m = ray.origin_W_m + way_m * ray.direction_W - gizmo_.p_W_m;
  if (arm_m.norm() < kNoDirection * gizmo_.ring_m()) return std::nullopt;
  return std::atan2(arm_m.dot(ring_v(axis_)), arm_m.dot(ring_u(axis_)));
}

void RingDrag::move_to(const view::Camera& camera, int width_px, int height_px,
                       const Eigen::Vector2d& pixel) {
  if (is_edge_on_) {
    angle_rad_ = (pixel - start_px_).dot(tangent_px_) / tangent_px_.squaredNorm();
    return;
  }
  const std::optional<double> direction = direction_rad(camera, width_px, height_px, pixel);
  if (!direction) return;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const double swept_rad = *direction - start_rad_;
  angle_rad_ = swept_rad + kTurn_rad * std::round((angle_rad_ - swept_rad) / kTurn_rad);
}

void RingDrag::add(view::Marks& marks, const view::Camera& camera) const {
  add_ring(marks, gizmo_, axis_, camera, true, gizmo_colour(axis_, true));
  for (const bool is_now : {false, true}) {
    const double angle_rad = start_rad_ + (is_now ? angle_rad_ : 0.0);
    view::add_rod(marks, gizmo_.p_W_m, gizmo_.p_W_m + gizmo_.ring_m() * radial(axis_, angle_rad),
                  kSpoke * gizmo_.length_m, gizmo_colour(axis_, is_now));
  }
}

}  // namespace koboshi::studio
