#pragma once

#include <Eigen/Core>

// Decompositions of 3 x 3 matrices that several layers need. Eigen's templates for them take one to three
// seconds of each source that instantiates them, so they are instantiated here alone.
namespace koboshi::mechanics {

// The shortest rotation that turns the z-axis into the direction of `normal`, which is not zero: the
// orientation of a plane. For the opposite of the z-axis, half a turn about some horizontal axis.
Eigen::Matrix3d rotation_to_normal(const Eigen::Vector3d& normal);

// Principal moments, ascending, in the unit of the inertia, and their axes as columns in the same order: an
// orthogonal matrix with a determinant of 1 or -1.
struct PrincipalInertia {
  Eigen::Vector3d moments;
  Eigen::Matrix3d axes;
};
// Reads the lower triangle of a symmetric matrix.
PrincipalInertia principal_inertia(const Eigen::Matrix3d& inertia);

}  // namespace koboshi::mechanics
