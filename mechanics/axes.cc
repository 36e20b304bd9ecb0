#include "mechanics/axes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace koboshi::mechanics {

Eigen::Matrix3d rotation_to_normal(const Eigen::Vector3d& normal) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
}

PrincipalInertia principal_inertia(const Eigen::Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace koboshi::mechanics
