#include "studio/view/camera_control.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace koboshi::studio {
namespace {

constexpr double kMaxElevation_rad = std::numbers::pi / 2.0;

// Rows: the camera's right, up and backward axes in the world.
Eigen::Matrix3d axes_W(const view::Camera& camera) {
  return camera.view().topLeftCorner<3, 3>().cast<double>();
}

// The height of the picture at this distance in front of the eye, per pixel.
double metres_per_pixel(const view::Camera& camera, int height_px, double depth_m) {
  return 2.0 * depth_m * std::tan(0.5 * camera.field_of_view_rad) / std::max(height_px, 1);
}

}  // namespace

void orbit(view::Camera& camera, const Eigen::Vector2d& drag_px, int height_px) {
  const double rad_per_px = std::numbers::pi / std::max(height_px, 1);
  camera.azimuth_rad = std::remainder(camera.azimuth_rad - rad_per_px * drag_px.x(), 2.0 * std::numbers::pi);
  camera.elevation_rad =
      std::clamp(camera.elevation_rad + rad_per_px * drag_px.y(), -kMaxElevation_rad, kMaxElevation_rad);
}

void pan(view::Camera& camera, const Eigen::Vector2d& drag_px, int height_px) {
  camera.target_W_m -= displacement_W_m(camera, height_px, camera.target_W_m, drag_px);
}

void zoom(view::Camera& camera, double factor) {
  camera.distance_m = std::clamp(camera.distance_m / factor, kNearest_m, kFarthest_m);
}

// With the target t, the distance d and the plane's normal n and offset o, the eye is clear where
//
//   n t + d (a cos e + n_z sin e) >= o + clearance,  a = n_x cos(azimuth) + n_y sin(azimuth)
//
// that is cos(e - phi) >= s / r with r = hypot(a, n_z), phi = atan2(n_z, a).
void raise_above(view::Camera& camera, std::span<const view::Plane> ground) {
  for (const view::Plane& plane : ground) {
    const Eigen::Vector3d& n = plane.normal_W;
    const double depth_m = plane.offset_m - n.dot(camera.target_W_m);
    if (depth_m > 0.0) camera.target_W_m.z() += depth_m / n.z();
    const double along = n.x() * std::cos(camera.azimuth_rad) + n.y() * std::sin(camera.azimuth_rad);
    const double wanted = (plane.offset_m + kClearance_m - n.dot(camera.target_W_m)) / camera.distance_m /
                          std::hypot(along, n.z());
    if (wanted <= -1.0) continue;
    const double lowest_rad = std::atan2(n.z(), along) - std::acos(std::min(wanted, 1.0));
    camera.elevation_rad = std::min(std::max(camera.elevation_rad, lowest_rad), kMaxElevation_rad);
  }
}

void lift_above(view::Camera& camera, std::span<const view::Plane> ground) {
  for (const view::Plane& plane : ground) {
    const double eye_m = plane.offset_m + kClearance_m - plane.normal_W.dot(camera.eye_W_m());
    const double target_m = plane.offset_m - plane.normal_W.dot(camera.target_W_m);
    camera.target_W_m.z() += std::max({0.0, eye_m, target_m}) / plane.normal_W.z();
  }
}

Ray ray_through(const view::Camera& camera, int width_px, int height_px, const Eigen::Vector2d& pixel) {
  const double scale = metres_per_pixel(camera, height_px, 1.0);
  const Eigen::Vector3d direction_C(scale * (pixel.x() - 0.5 * width_px),
                                    scale * (0.5 * height_px - pixel.y()), -1.0);
  return {camera.eye_W_m(), (axes_W(camera).transpose() * direction_C).normalized()};
}

Eigen::Vector3d displacement_W_m(const view::Camera& camera, int height_px, const Eigen::Vector3d& p_W_m,
                                 const Eigen::Vector2d& drag_px) {
  const Eigen::Matrix3d axes = axes_W(camera);
  const double depth_m = axes.row(2).dot(camera.eye_W_m() - p_W_m);
  const double scale = metres_per_pixel(camera, height_px, depth_m);
  return scale * (drag_px.x() * axes.row(0) - drag_px.y() * axes.row(1)).transpose();
}

}  // namespace koboshi::studio
