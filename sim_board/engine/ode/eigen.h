#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace koboshi::sim_board {

// Converts ODE's arrays (4-element vectors, 3x4 rotation matrices) to Eigen's types.

inline Eigen::Vector3d vector_of(const dReal* v) { return {v[0], v[1], v[2]}; }

inline void copy_vector(const Eigen::Vector3d& from, dVector3 to) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
  to[3] = 0.0;
}

inline Eigen::Matrix3d rotation_of(const dReal* R) {
  Eigen::Matrix3d rotation;
  rotation << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  return rotation;
}

inline void copy_rotation(const Eigen::Matrix3d& rotation, dMatrix3 R) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) R[4 * row + column] = rotation(row, column);
    R[4 * row + 3] = 0.0;
  }
}

// Pose of a body; its frame is at the centre of mass.
inline Eigen::Isometry3d pose_of(dBodyID body) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_of(dBodyGetRotation(body));
  pose.translation() = vector_of(dBodyGetPosition(body));
  return pose;
}

inline Eigen::Isometry3d pose_of(dGeomID geom) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_of(dGeomGetRotation(geom));
  pose.translation() = vector_of(dGeomGetPosition(geom));
  return pose;
}

inline void set_pose(dBodyID body, const Eigen::Isometry3d& pose) {
  dMatrix3 R;
  copy_rotation(pose.linear(), R);
  dBodySetRotation(body, R);
  dBodySetPosition(body, pose.translation().x(), pose.translation().y(), pose.translation().z());
}

}  // namespace koboshi::sim_board
