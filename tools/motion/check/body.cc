#include "tools/motion/check/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "sim_board/world/foot.h"
#include "sim_board/world/gravity.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/support_polygon.h"

namespace koboshi::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint32_t kFootMask = 0xF;  // of the corners of one foot

Matrix3d rotation(const Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

}  // namespace

Body::Body(const sim_board::RobotDescription& robot) {
  const sim_board::LinkTree tree(robot);
  for (const int index : tree.joints_from_root()) {
    const sim_board::JointDescription& joint = robot.joints[static_cast<std::size_t>(index)];
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    const Eigen::Isometry3d X_PM = robot.links[parent].X_ML.inverse();
    const Eigen::Isometry3d X_PC = X_PM * robot.links[child].X_ML;
    const Vector3d anchor_P = X_PM * joint.p_MJ;
    joints_.push_back({.index = static_cast<std::size_t>(index),
                       .parent = parent,
                       .child = child,
                       .axis_P = X_PM.linear() * joint.axis_M,
                       .anchor_P = anchor_P,
                       .R_PC = X_PC.linear(),
                       .p_AC_P = X_PC.translation() - anchor_P});
  }
  for (const sim_board::LinkDescription& link : robot.links) {
    links_.push_back({link.mass_kg, link.p_LCom_L, link.I_LCom_L});
    mass_kg_ += link.mass_kg;
  }
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
  places_.R_BL.resize(links_.size());
  places_.p_BL.resize(links_.size());
  axes_B_.resize(joints_.size());
  anchors_B_.resize(joints_.size());
  motions_.resize(links_.size());
  wrenches_.resize(links_.size());
  const std::vector<double> zero(joints_.size(), 0.0);
  Stance stance;
  solve_at_rest(zero, stance);
  com_height_m_ = stance.com_height_m;
}

void Body::place(std::span<const double> angles_rad, LinkPlaces& places) const {
  places.R_BL.resize(links_.size());
  places.p_BL.resize(links_.size());
  places.R_BL[0].setIdentity();
  places.p_BL[0].setZero();
  for (const Joint& joint : joints_) {
    const Matrix3d& R_BP = places.R_BL[joint.parent];
    const Matrix3d turn_P = rotation(joint.axis_P, angles_rad[joint.index]);
    places.R_BL[joint.child] = R_BP * (turn_P * joint.R_PC);
    places.p_BL[joint.child] = places.p_BL[joint.parent] + R_BP * (joint.anchor_P + turn_P * joint.p_AC_P);
  }
}

// The attitude at which the body is put down: on the plane of a sole with the other foot above it, or between
// the two planes.
Vector3d Body::initial_up() const {
  std::array<Vector3d, 2> normals;
  std::array<bool, 2> is_lower{};
  for (std::size_t side = 0; side < 2; ++side) {
    normals[side] = places_.R_BL[feet_[side].link] * feet_[side].normal_L;
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
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Matrix3d& R_BP = places_.R_BL[joints_[j].parent];
    axes_B_[j] = R_BP * joints_[j].axis_P;
    anchors_B_[j] = places_.p_BL[joints_[j].parent] + R_BP * joints_[j].anchor_P;
  }
  for (std::size_t i = 0; i < corners_B_.size(); ++i) {
    const Foot& foot = feet_[i / 4];
    corners_B_[i] = places_.p_BL[foot.link] + places_.R_BL[foot.link] * foot.corners_L[i % 4];
  }
  com_B_.setZero();
  for (std::size_t l = 0; l < links_.size(); ++l)
    com_B_ += links_[l].mass_kg * (places_.p_BL[l] + places_.R_BL[l] * links_[l].com_L);
  com_B_ /= mass_kg_;
  stance.rest = find_rest(corners_B_, com_B_, initial_up(), kTouching_m);
  stance.com_m = GroundAxes(stance.rest.up_B).flat(com_B_);
  stance.com_height_m = stance.rest.up_B.dot(com_B_) - stance.rest.height_m;
}

// Speeds and accelerations of the links relative to B, in axes of B.
void Body::set_rates(std::span<const double> speeds, std::span<const double> accelerations) {
  motions_[0] = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    const Motion& parent = motions_[joint.parent];
    Motion& child = motions_[joint.child];
    const Vector3d to_anchor = anchors_B_[j] - places_.p_BL[joint.parent];
    const Vector3d from_anchor = places_.p_BL[joint.child] - anchors_B_[j];
    const Vector3d spin = speeds[joint.index] * axes_B_[j];
    child.w = parent.w + spin;
    child.dw = parent.dw + accelerations[joint.index] * axes_B_[j] + parent.w.cross(spin);
    child.v = parent.v + parent.w.cross(to_anchor) + child.w.cross(from_anchor);
    child.dv = parent.dv + parent.dw.cross(to_anchor) + parent.w.cross(parent.w.cross(to_anchor)) +
               child.dw.cross(from_anchor) + child.w.cross(child.w.cross(from_anchor));
  }
}

// Moves B so that the foot is at rest, and makes all motions absolute.
void Body::fix_support_foot(std::size_t side) {
  const std::size_t link = feet_[side].link;
  const Motion foot = motions_[link];
  const Vector3d& r = places_.p_BL[link];
  const Vector3d w_B = -foot.w;
  const Vector3d dw_B = -foot.dw;
  const Vector3d dv_B = -(dw_B.cross(r) + w_B.cross(w_B.cross(r)) + 2.0 * w_B.cross(foot.v) + foot.dv);
  for (std::size_t l = 0; l < motions_.size(); ++l) {
    Motion& motion = motions_[l];
    const Vector3d& p = places_.p_BL[l];
    motion.dv += dv_B + dw_B.cross(p) + w_B.cross(w_B.cross(p)) + 2.0 * w_B.cross(motion.v);
    motion.dw += dw_B + w_B.cross(motion.w);
    motion.w += w_B;
  }
}

// The wrench that each link needs for its motion against gravity; returns the sum.
Body::Wrench Body::link_wrenches(const Vector3d& up_B) {
  Wrench total;
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const LinkMass& link = links_[l];
    const Motion& motion = motions_[l];
    const Matrix3d& R = places_.R_BL[l];
    const Vector3d com_offset = R * link.com_L;
    const Vector3d acceleration = motion.dv + motion.dw.cross(com_offset) +
                                  motion.w.cross(motion.w.cross(com_offset)) +
                                  sim_board::kGravity_m_per_s2 * up_B;
    const Vector3d w_L = R.transpose() * motion.w;
    const Vector3d moment_L =
        link.inertia_L * (R.transpose() * motion.dw) + w_L.cross(Vector3d(link.inertia_L * w_L));
    Wrench& wrench = wrenches_[l];
    wrench.force = link.mass_kg * acceleration;
    wrench.moment = R * moment_L + (places_.p_BL[l] + com_offset).cross(wrench.force);
    total.force += wrench.force;
    total.moment += wrench.moment;
  }
  return total;
}

void Body::divide_load(const Wrench& total, Stance& stance) {
  const Vector3d& up = stance.rest.up_B;
  const Vector3d zmp_B = (up.cross(total.moment) + stance.rest.height_m * total.force) / up.dot(total.force);
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
    const Vector3d force = stance.load_share[side] * total.force;
    Wrench& wrench = wrenches_[feet_[side].link];
    wrench.force -= force;
    wrench.moment -= Vector3d(middles[side] + zmp_B - middle).cross(force);
  }
}

void Body::finish(Stance& stance, std::span<const double> accelerations) {
  stance.torques_Nm.resize(joints_.size());
  for (std::size_t j = joints_.size(); j-- > 0;) {
    const Joint& joint = joints_[j];
    const Wrench& wrench = wrenches_[joint.child];
    stance.torques_Nm[joint.index] = axes_B_[j].dot(wrench.moment - anchors_B_[j].cross(wrench.force)) +
                                     rotor_inertias_kg_m2_[joint.index] * accelerations[joint.index];
    wrenches_[joint.parent].force += wrench.force;
    wrenches_[joint.parent].moment += wrench.moment;
  }
}

void Body::solve(std::span<const double> angles_rad, std::span<const double> speeds,
                 std::span<const double> accelerations, Stance& stance) {
  place(angles_rad, places_);
  find_support(stance);
  set_rates(speeds, accelerations);
  const int left = std::popcount(stance.rest.corners & kFootMask);
  const int right = std::popcount(stance.rest.corners >> 4 & kFootMask);
  fix_support_foot(right > left ? 1 : 0);
  divide_load(link_wrenches(stance.rest.up_B), stance);
  finish(stance, accelerations);
}

void Body::solve_at_rest(std::span<const double> angles_rad, Stance& stance) {
  place(angles_rad, places_);
  find_support(stance);
  const std::vector<double> zero(joints_.size(), 0.0);
  for (Motion& motion : motions_)
    motion = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  divide_load(link_wrenches(stance.rest.up_B), stance);
  finish(stance, zero);
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
