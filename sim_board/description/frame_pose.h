#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace koboshi::sim_board {

// A rotation as a quaternion. The order of the operations in this file is part of the robot's description:
// another one would change its last bits (docs/decision/0022-robot-files-without-libsdformat.md). Therefore
// they are written out, in plain arithmetic that no compiler may reorder.
struct FrameRotation {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  // Rotations in rad about the fixed axes x, y and z, in this order.
  static FrameRotation from_angles(double roll, double pitch, double yaw);

  FrameRotation normalized() const;
  FrameRotation inverse() const;
  Eigen::Vector3d rotate(const Eigen::Vector3d& vector) const;
  Eigen::Matrix3d matrix() const;
};

// First `b`, then `a`.
FrameRotation operator*(const FrameRotation& a, const FrameRotation& b);

// The pose of a frame F in a frame B.
struct FramePose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of F's origin in B, m
  FrameRotation rotation;                              // from F's axes to B's

  // From the numbers of a <pose>: x, y, z in m, then roll, pitch, yaw in rad.
  static FramePose from_numbers(const std::vector<double>& numbers);

  FramePose inverse() const;
  Eigen::Isometry3d isometry() const;
};

// The pose of G in B, from those of F in B and of G in F.
FramePose operator*(const FramePose& X_BF, const FramePose& X_FG);

// R I R^T: an inertia matrix in the axes to which `rotation` leads.
Eigen::Matrix3d rotated_inertia(const FrameRotation& rotation, const Eigen::Matrix3d& inertia);

// Returns the rotations about the fixed axes x, y and z, in this order, that make up R: the last three
// numbers of a <pose>, in rad. The rotation about z is zero where x and z coincide.
Eigen::Vector3d fixed_axis_angles(const Eigen::Matrix3d& R);

}  // namespace koboshi::sim_board
