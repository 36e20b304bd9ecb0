#include "tests/unit/mechanics/random_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace koboshi::mechanics {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using sim_board::RandomStream;

Isometry3d random_pose(RandomStream& random) {
  const Vector3d p = random_vector(random, 0.2);
  const Vector3d axis = random_vector(random, 1.0).normalized();
  return Eigen::Translation3d(p) * Eigen::AngleAxisd(random.within(3.0), axis);
}

Matrix3d rotation(const Vector3d& axis, double angle_rad) {
  Matrix3d cross;
  cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return Matrix3d::Identity() + std::sin(angle_rad) * cross + (1.0 - std::cos(angle_rad)) * cross * cross;
}

}  // namespace

Vector3d random_vector(RandomStream& random, double bound) {
  const double x = random.within(bound);
  const double y = random.within(bound);
  return {x, y, random.within(bound)};
}

HingeTree random_tree(RandomStream& random, std::size_t links) {
  std::vector<Link> bodies(links);
  for (Link& link : bodies) {
    Matrix3d root;
    for (double& value : root.reshaped()) value = random.within(0.1);
    link = {.mass_kg = 0.1 + random.uniform(),
            .p_LCom_L = random_vector(random, 0.1),
            .I_LCom_L = root * root.transpose() + 1e-3 * Matrix3d::Identity(),
            .X_ML = random_pose(random)};
  }
  std::vector<Hinge> hinges;
  for (std::size_t child = 1; child < links; ++child)
    hinges.push_back({.parent = random.bits() % child,
                      .child = child,
                      .p_MJ = random_vector(random, 0.3),
                      .axis_M = random_vector(random, 1.0).normalized()});
  std::ranges::reverse(hinges);
  return {std::move(bodies), std::move(hinges)};
}

std::vector<double> random_numbers(RandomStream& random, std::size_t count, double bound) {
  std::vector<double> numbers(count);
  for (double& number : numbers) number = random.within(bound);
  return numbers;
}

Isometry3d reference_pose(const HingeTree& tree, std::size_t link, const std::vector<double>& positions_rad) {
  // From M at joint positions zero to the root's frame; hinges nearer to the root act later.
  Isometry3d moved = tree.links()[link].X_ML;
  for (std::size_t at = link; at != 0;) {
    const auto hinge = std::ranges::find(tree.hinges(), at, &Hinge::child);
    const auto index = static_cast<std::size_t>(hinge - tree.hinges().begin());
    const Matrix3d R = rotation(hinge->axis_M, positions_rad[index]);
    moved.translation() = hinge->p_MJ + R * (moved.translation() - hinge->p_MJ);
    moved.linear() = R * moved.linear();
    at = hinge->parent;
  }
  return tree.links()[0].X_ML.inverse() * moved;
}

}  // namespace koboshi::mechanics
