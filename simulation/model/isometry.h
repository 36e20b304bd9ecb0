#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/geometry.h"
#include "firmware/robot/leg.h"

namespace koboshi::simulation {

// The firmware's positions (m), directions and poses in double precision, and what is computed of them.

[[nodiscard]] inline Eigen::Vector3d vector_of(const robot::Position& p) {
  return {fixed::to_double(p.x), fixed::to_double(p.y), fixed::to_double(p.z)};
}
[[nodiscard]] inline Eigen::Vector3d vector_of(const robot::Direction& v) {
  return {fixed::to_double(v.x), fixed::to_double(v.y), fixed::to_double(v.z)};
}
[[nodiscard]] inline Eigen::Isometry3d isometry_of(const robot::Pose& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row)
    X.linear().row(row) = vector_of(pose.R.rows[static_cast<std::size_t>(row)]).transpose();
  X.translation() = vector_of(pose.p);
  return X;
}

// The middle between the hips (H) of both legs at joint zero, in axes of the trunk.
[[nodiscard]] inline Eigen::Vector3d hip_centre_B(const std::array<robot::LegGeometry, 2>& legs) {
  return 0.5 * (vector_of(legs[0].p_BH_B) + vector_of(legs[1].p_BH_B));
}

// Roll, pitch and yaw of a rotation about the fixed axes x, y, z, in rad.
[[nodiscard]] inline Eigen::Vector3d rpy_of(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
          std::atan2(R(1, 0), R(0, 0))};
}

// The frame midway between those of two soles, whose axes are the mean of theirs.
[[nodiscard]] inline Eigen::Isometry3d midway(const Eigen::Isometry3d& left, const Eigen::Isometry3d& right) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = 0.5 * (left.translation() + right.translation());
  const Eigen::Vector3d z = (left.linear().col(2) + right.linear().col(2)).normalized();
  const Eigen::Vector3d along = left.linear().col(0) + right.linear().col(0);
  const Eigen::Vector3d x = (along - along.dot(z) * z).normalized();
  X.linear() << x, z.cross(x), z;
  return X;
}

}  // namespace koboshi::simulation
