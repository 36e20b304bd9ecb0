#include "view/render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace koboshi::view {
namespace {

constexpr double kMaxElevation_rad = std::numbers::pi / 2.0 - 1e-3;
// Clipping planes relative to the distance of the target. Depth resolution at the target, with 24 bits: 0.1
// mm.
constexpr double kNear = 0.05;
constexpr double kFar = 100.0;

}  // namespace

Eigen::Vector3d Camera::eye_W_m() const {
  const double elevation_rad = std::clamp(this->elevation_rad, -kMaxElevation_rad, kMaxElevation_rad);
  const Eigen::Vector3d towards_eye(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                    std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad));
  return target_W_m + distance_m * towards_eye;
}

Eigen::Matrix4f Camera::view() const {
  const Eigen::Vector3d eye_m = eye_W_m();
  return look_along(eye_m, target_W_m - eye_m, Eigen::Vector3d::UnitZ());
}

Eigen::Matrix4f Camera::projection(double aspect) const {
  const double near_m = kNear * distance_m;
  const double far_m = kFar * distance_m;
  const double focal = 1.0 / std::tan(0.5 * field_of_view_rad);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  matrix(0, 0) = focal / aspect;
  matrix(1, 1) = focal;
  matrix(2, 2) = (far_m + near_m) / (near_m - far_m);
  matrix(2, 3) = 2.0 * far_m * near_m / (near_m - far_m);
  matrix(3, 2) = -1.0;
  return matrix.cast<float>();
}

Eigen::Matrix4f orthographic(double half_width_m, double near_m, double far_m) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(0, 0) = 1.0 / half_width_m;
  matrix(1, 1) = 1.0 / half_width_m;
  matrix(2, 2) = 2.0 / (near_m - far_m);
  matrix(2, 3) = (far_m + near_m) / (near_m - far_m);
  return matrix.cast<float>();
}

Eigen::Matrix4f look_along(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& forward,
                           const Eigen::Vector3d& up) {
  const Eigen::Vector3d backward = -forward.normalized();
  const Eigen::Vector3d right = up.cross(backward).normalized();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.block<1, 3>(0, 0) = right.transpose();
  matrix.block<1, 3>(1, 0) = backward.cross(right).transpose();
  matrix.block<1, 3>(2, 0) = backward.transpose();
  matrix.block<3, 1>(0, 3) = -matrix.block<3, 3>(0, 0) * eye_m;
  return matrix.cast<float>();
}

Eigen::Vector2d project(const Camera& camera, int width_px, int height_px, const Eigen::Vector3d& p_W_m) {
  const double aspect = static_cast<double>(width_px) / height_px;
  const Eigen::Vector4d clip =
      (camera.projection(aspect) * camera.view()).cast<double>() * p_W_m.homogeneous();
  return {0.5 * width_px * (1.0 + clip.x() / clip.w()), 0.5 * height_px * (1.0 - clip.y() / clip.w())};
}

double distance_to_fit(const Camera& camera, double aspect, double radius_m) {
  const double half_height_rad = 0.5 * camera.field_of_view_rad;
  const double half_width_rad = std::atan(std::tan(half_height_rad) * aspect);
  return radius_m / std::sin(std::min(half_height_rad, half_width_rad));
}

}  // namespace koboshi::view
