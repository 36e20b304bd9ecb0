#include "studio/view/gizmo.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "studio/view/ring.h"

namespace koboshi::studio {
namespace {

constexpr double kReach_px = 7.0;      // of the mouse from an arrow's image
constexpr double kRingReach_px = 4.0;  // the lines are 2 to 3 pixels wide
constexpr double kInner = 0.35;        // share of an arrow, and of a ring's radius, that does not count
constexpr double kRing = 0.7;         // radius of the rings, as a share of an arrow's length: behind its head
constexpr double kRadius = 0.035;     // of an arrow's shaft, as a share of its length
constexpr double kShortest_px = 8.0;  // image of an arrow that can be dragged
constexpr std::array<view::Colour, 3> kColours{
    {{0.86F, 0.15F, 0.16F}, {0.16F, 0.62F, 0.20F}, {0.16F, 0.36F, 0.85F}}};
constexpr view::Colour kChosen{1.0F, 0.80F, 0.10F};

Eigen::Vector3d tip_W_m(const Gizmo& gizmo, int axis) {
  return gizmo.p_W_m + gizmo.length_m * Eigen::Vector3d::Unit(axis);
}

std::optional<NearHandle> pick_arrow(const Gizmo& gizmo, const view::Camera& camera, int width_px,
                                     int height_px, const Eigen::Vector2d& pixel, double reach_px) {
  const Eigen::Vector2d origin_px = view::project(camera, width_px, height_px, gizmo.p_W_m);
  std::optional<NearHandle> nearest;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector2d arrow_px =
        view::project(camera, width_px, height_px, tip_W_m(gizmo, axis)) - origin_px;
    if (arrow_px.norm() < kShortest_px) continue;
    const double share = (pixel - origin_px).dot(arrow_px) / arrow_px.squaredNorm();
    const double distance_px = (origin_px + std::clamp(share, kInner, 1.0) * arrow_px - pixel).norm();
    if (distance_px >= (nearest ? nearest->distance_px : reach_px)) continue;
    nearest = {{Handle::Kind::kArrow, axis}, distance_px};
  }
  return nearest;
}

std::optional<NearHandle> pick_ring(const Gizmo& gizmo, const view::Camera& camera, int width_px,
                                    int height_px, const Eigen::Vector2d& pixel, double surface_m,
                                    double reach_px) {
  if (!gizmo.rotates) return std::nullopt;
  const Eigen::Vector2d origin_px = view::project(camera, width_px, height_px, gizmo.p_W_m);
  const Eigen::Vector3d right_W = camera.view().row(0).head<3>().cast<double>();
  const double radius_px =
      (view::project(camera, width_px, height_px, gizmo.p_W_m + gizmo.ring_m() * right_W) - origin_px).norm();
  if ((pixel - origin_px).norm() < kInner * radius_px) return std::nullopt;
  std::optional<NearHandle> nearest;
  for (int axis = 0; axis < 3; ++axis) {
    const RingPoint point = nearest_on_ring(gizmo, axis, camera, width_px, height_px, pixel);
    if (point.distance_px >= (nearest ? nearest->distance_px : reach_px)) continue;
    if (point.from_eye_m > surface_m + kRadius * gizmo.length_m) continue;
    nearest = {{Handle::Kind::kRing, axis}, point.distance_px};
  }
  return nearest;
}

}  // namespace

double Gizmo::ring_m() const { return kRing * length_m; }

view::Colour gizmo_colour(int axis, bool chosen) {
  return chosen ? kChosen : kColours[static_cast<std::size_t>(axis)];
}

void add_gizmo(view::Marks& marks, const Gizmo& gizmo, const view::Camera& camera,
               const std::optional<Handle>& chosen) {
  for (int axis = 0; axis < 3; ++axis)
    view::add_arrow(marks, gizmo.p_W_m, tip_W_m(gizmo, axis), kRadius * gizmo.length_m,
                    gizmo_colour(axis, chosen == Handle{Handle::Kind::kArrow, axis}));
  for (int axis = 0; axis < 3 && gizmo.rotates; ++axis)
    add_ring(marks, gizmo, axis, camera, false,
             gizmo_colour(axis, chosen == Handle{Handle::Kind::kRing, axis}));
}

std::optional<Handle> pick_handle(const Gizmo& gizmo, const view::Camera& camera, int width_px, int height_px,
                                  const Eigen::Vector2d& pixel, double surface_m) {
  auto found = pick_arrow(gizmo, camera, width_px, height_px, pixel, kReach_px);
  if (!found) found = pick_ring(gizmo, camera, width_px, height_px, pixel, surface_m, kRingReach_px);
  return found ? std::optional(found->handle) : std::nullopt;
}

std::optional<NearHandle> nearest_handle(const Gizmo& gizmo, const view::Camera& camera, int width_px,
                                         int height_px, const Eigen::Vector2d& pixel, double surface_m,
                                         double reach_px) {
  const auto arrow = pick_arrow(gizmo, camera, width_px, height_px, pixel, reach_px);
  const auto ring =
      pick_ring(gizmo, camera, width_px, height_px, pixel, surface_m, arrow ? arrow->distance_px : reach_px);
  return ring ? ring : arrow;
}

Eigen::Vector3d along_axis_W_m(const Gizmo& gizmo, int axis, const view::Camera& camera, int width_px,
                               int height_px, const Eigen::Vector2d& drag_px) {
  const Eigen::Vector2d arrow_px = view::project(camera, width_px, height_px, tip_W_m(gizmo, axis)) -
                                   view::project(camera, width_px, height_px, gizmo.p_W_m);
  if (arrow_px.norm() < kShortest_px) return Eigen::Vector3d::Zero();
  return gizmo.length_m * drag_px.dot(arrow_px) / arrow_px.squaredNorm() * Eigen::Vector3d::Unit(axis);
}

Eigen::Vector3d rotation_W_rad(const view::Camera& camera, int height_px, const Eigen::Vector2d& drag_px) {
  const Eigen::Matrix3d axes_W = camera.view().topLeftCorner<3, 3>().cast<double>();
  const double rad_per_px = std::numbers::pi / std::max(height_px, 1);
  return rad_per_px * (drag_px.x() * axes_W.row(1) + drag_px.y() * axes_W.row(0)).transpose();
}

}  // namespace koboshi::studio
