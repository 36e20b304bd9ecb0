#include "tools/motion_check/body.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/gravity.h"
#include "sim_board/world/support_polygon.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using mechanics::Vector6;

constexpr std::uint32_t kFootMask = 0xF;  // of the corners of one foot

}  // namespace

Body::Body(const sim_board::RobotDescription& robot)
    : dynamics_(sim_board::hinge_tree(robot)), at_rest_(robot.joints.size(), 0.0) {
  for (const sim_board::JointDescription& joint : robot.joints)
    rotor_inertias_kg_m2_.push_back(joint.servo.rotor_inertia_kg_m2);
  const auto feet = sim_board::feet_of(robot);
  for (std::size_t side = 0; side < feet_.size(); ++side) {
    if (!feet[side] || feet[side]->corners_L.size() != 4)
      throw std::invalid_argument("robot '" + robot.name + "' has no two feet of one box each");
    feet_[side].link = static_cast<std::size_t>(feet[side]->link);
    std::copy_n(feet[side]->corners_L.begin(), 4, feet_[side].corners_L.begin());
    feet_[side].normal_L = feet[side]->X_LSole.linear().col(2);
  }
  Stance stance;
  solve_at_rest(at_rest_, stance);
  com_height_m_ = stance.com_height_m;
}

// The attitude at which the body is put down: on the plane of a sole with the other foot above it, or between
// the two planes.
Vector3d Body::initial_up() const {
  std::array<Vector3d, 2> normals;
  std::array<bool, 2> is_lower{};
  for (std::size_t side = 0; side < 2; ++side) {
    normals[side] = X_BLs()[feet_[side].link].linear() * feet_[side].normal_L;
    const double plane_m = normals[side].dot(corners_B_[4 * side]);
    is_lower[side] = true;
    for (std::size_t i = 0; i < 4; ++i)
      is_lower[side] =
          is_lower[side] && normals[side].dot(corners_B_[4 * (1 - side) + i]) >= plane_m - kTouching_m;
  }
  if (is_lower[0] != is_lower[1]) return normals[is_lower[0] ? 0 : 1];
  return (normals[0] + normals[1]).normalized();
}

void Body::find_support(Stance& stance) {
  for (std::size_t i = 0; i < corners_B_.size(); ++i) {
    const Foot& foot = feet_[i / 4];
    corners_B_[i] = X_BLs()[foot.link] * foot.corners_L[i % 4];
  }
  const Vector3d& com_B = dynamics_.com_B();
  stance.rest = find_rest(corners_B_, com_B, initial_up(), kTouching_m);
  stance.com_m = GroundAxes(stance.rest.up_B).flat(com_B);
  stance.com_height_m = stance.rest.up_B.dot(com_B) - stance.rest.height_m;
}

void Body::divide_load(const Vector6& total, Stance& stance) {
  const Vector3d& up = stance.rest.up_B;
  const Vector3d total_force = total.tail<3>();
  const Vector3d zmp_B =
      (up.cross(total.head<3>()) + stance.rest.height_m * total_force) / up.dot(total_force);
  stance.zmp_m = GroundAxes(up).flat(zmp_B);
  std::array<Vector3d, 2> middles;
  std::array<int, 2> counts{};
  for (std::size_t side = 0; side < 2; ++side) {
    middles[side].setZero();
    for (std::size_t i = 4 * side; i < 4 * side + 4; ++i) {
      if ((stance.rest.corners >> i & 1U) == 0) continue;
      middles[side] += corners_B_[i];
      ++counts[side];
    }
    if (counts[side] > 0) middles[side] /= counts[side];
  }
  double left_share = counts[0] > 0 ? 1.0 : 0.0;
  if (counts[0] > 0 && counts[1] > 0) {
    const Vector3d across = middles[0] - middles[1];
    left_share = std::clamp((zmp_B - middles[1]).dot(across) / across.squaredNorm(), 0.0, 1.0);
  }
  stance.load_share = {left_share, 1.0 - left_share};
  const Vector3d middle = left_share * middles[0] + (1.0 - left_share) * middles[1];
  for (std::size_t side = 0; side < 2; ++side) {
    if (counts[side] == 0) continue;
    const Vector3d pressure_B = middles[side] + zmp_B - middle;
    dynamics_.support(feet_[side].link,
                      mechanics::spatial_force(pressure_B, stance.load_share[side] * total_force));
  }
}

void Body::solve(std::span<const double> angles_rad, std::span<const double> speeds,
                 std::span<const double> accelerations, Stance& stance) {
  dynamics_.place(angles_rad);
  find_support(stance);
  const int left = std::popcount(stance.rest.corners & kFootMask);
  const int right = std::popcount(stance.rest.corners >> 4 & kFootMask);
  const Foot& support = feet_[right > left ? 1 : 0];
  divide_load(dynamics_.find_forces(speeds, accelerations, support.link,
                                    -sim_board::kGravity_m_per_s2 * stance.rest.up_B),
              stance);
  stance.torques_Nm.resize(joint_count());
  dynamics_.find_torques(stance.torques_Nm);
  for (std::size_t j = 0; j < joint_count(); ++j)
    stance.torques_Nm[j] += rotor_inertias_kg_m2_[j] * accelerations[j];
}

void Body::solve_at_rest(std::span<const double> angles_rad, Stance& stance) {
  solve(angles_rad, at_rest_, at_rest_, stance);
}

std::vector<Vector2d> Body::support_polygon(const Stance& stance) const {
  const GroundAxes axes(stance.rest.up_B);
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < corners_B_.size(); ++i) {
    if ((stance.rest.corners >> i & 1U) != 0) points.push_back(axes.flat(corners_B_[i]));
  }
  std::vector<Vector2d> hull = sim_board::convex_hull(points);
  if (points.size() == corners_B_.size()) return hull;
  for (std::size_t i = 0; i < corners_B_.size(); ++i) {
    if ((stance.rest.corners >> i & 1U) != 0) continue;
    const Vector2d corner = axes.flat(corners_B_[i]);
    const double height_m = stance.rest.up_B.dot(corners_B_[i]) - stance.rest.height_m;
    const double outside_m = -margin_in(hull, corner).distance_m;
    if (height_m < outside_m * std::tan(kNearRoll_rad)) points.push_back(corner);
  }
  return sim_board::convex_hull(std::move(points));
}

}  // namespace koboshi::tools
