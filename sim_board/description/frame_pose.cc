#include "sim_board/description/frame_pose.h"

#include <cmath>

namespace koboshi::sim_board {
namespace {

double squared_norm(const FrameRotation& q) { return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z; }

Eigen::Vector3d cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

Eigen::Matrix3d product(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  Eigen::Matrix3d c;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      c(row, column) = a(row, 0) * b(0, column) + a(row, 1) * b(1, column) + a(row, 2) * b(2, column);
  return c;
}

}  // namespace

FrameRotation FrameRotation::from_angles(double roll, double pitch, double yaw) {
  const double cos_r = std::cos(roll / 2.0);
  const double sin_r = std::sin(roll / 2.0);
  const double cos_p = std::cos(pitch / 2.0);
  const double sin_p = std::sin(pitch / 2.0);
  const double cos_y = std::cos(yaw / 2.0);
  const double sin_y = std::sin(yaw / 2.0);
  return FrameRotation{
      cos_r * cos_p * cos_y + sin_r * sin_p * sin_y, sin_r * cos_p * cos_y - cos_r * sin_p * sin_y,
      cos_r * sin_p * cos_y + sin_r * cos_p * sin_y, cos_r * cos_p * sin_y - sin_r * sin_p * cos_y}
      .normalized();
}

FrameRotation FrameRotation::normalized() const {
  const double norm = std::sqrt(squared_norm(*this));
  return {w / norm, x / norm, y / norm, z / norm};
}

FrameRotation FrameRotation::inverse() const {
  const double square = squared_norm(*this);
  return {w / square, -x / square, -y / square, -z / square};
}

Eigen::Vector3d FrameRotation::rotate(const Eigen::Vector3d& vector) const {
  const Eigen::Vector3d imaginary(x, y, z);
  const Eigen::Vector3d once = cross(imaginary, vector);
  const Eigen::Vector3d twice = cross(imaginary, once);
  Eigen::Vector3d rotated;
  for (int i = 0; i < 3; ++i) rotated[i] = vector[i] + once[i] * (2.0 * w) + twice[i] * 2.0;
  return rotated;
}

Eigen::Matrix3d FrameRotation::matrix() const {
  const FrameRotation q = normalized();
  Eigen::Matrix3d m;
  m << 1 - 2 * q.y * q.y - 2 * q.z * q.z, 2 * q.x * q.y - 2 * q.z * q.w, 2 * q.x * q.z + 2 * q.y * q.w,
      2 * q.x * q.y + 2 * q.z * q.w, 1 - 2 * q.x * q.x - 2 * q.z * q.z, 2 * q.y * q.z - 2 * q.x * q.w,
      2 * q.x * q.z - 2 * q.y * q.w, 2 * q.y * q.z + 2 * q.x * q.w, 1 - 2 * q.x * q.x - 2 * q.y * q.y;
  return m;
}

FrameRotation operator*(const FrameRotation& a, const FrameRotation& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

FramePose FramePose::from_numbers(const std::vector<double>& n) {
  return {{n[0], n[1], n[2]}, FrameRotation::from_angles(n[3], n[4], n[5])};
}

FramePose FramePose::inverse() const {
  const FrameRotation turned_back = rotation.inverse();
  return {turned_back.rotate(-position), turned_back};
}

Eigen::Isometry3d FramePose::isometry() const {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() =
      Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z).normalized().toRotationMatrix();
  isometry.translation() = position;
  return isometry;
}

FramePose operator*(const FramePose& X_BF, const FramePose& X_FG) {
  const FrameRotation offset{0.0, X_FG.position.x(), X_FG.position.y(), X_FG.position.z()};
  const FrameRotation turned = X_BF.rotation * (offset * X_BF.rotation.inverse());
  return {{X_BF.position.x() + turned.x, X_BF.position.y() + turned.y, X_BF.position.z() + turned.z},
          X_BF.rotation * X_FG.rotation};
}

Eigen::Matrix3d rotated_inertia(const FrameRotation& rotation, const Eigen::Matrix3d& inertia) {
  const Eigen::Matrix3d R = rotation.matrix();
  return product(product(R, inertia), R.transpose());
}

Eigen::Vector3d fixed_axis_angles(const Eigen::Matrix3d& R) {
  // R = Rz(yaw) Ry(pitch) Rx(roll).
  const double cosine = std::hypot(R(0, 0), R(1, 0));
  const double pitch_rad = std::atan2(-R(2, 0), cosine);
  if (cosine < 1e-9) return {std::atan2(R(2, 0) < 0.0 ? R(0, 1) : -R(0, 1), R(1, 1)), pitch_rad, 0.0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch_rad, std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace koboshi::sim_board
