#include "studio/document/drag_reach.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "firmware/fixed/host/convert.h"
#include "sim_board/description/hinge_tree.h"

namespace koboshi::studio {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using robot::JointRole;

// Length by which a rotation counts as a distance: that of a foot.
constexpr double kLever_m = 0.1;
// Error below which a constraint counts as kept; the tests ask for twice as much.
constexpr double kKept_m = 5e-5;
// A pose that another start finds has to be nearer by this, so that the branch does not change in a drag.
constexpr double kNearer_m = 2e-4;
// Other starts for an arm, as shares of the ranges of its joints
// (simulation/motion_language/parse/body_targets.cc).
constexpr std::array kStarts{0.5, 0.25, 0.75};

Vector3d rotation_vector(const Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

Matrix3d matrix_of(const Vector3d& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  if (angle_rad == 0.0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad).toRotationMatrix();
}

bool is_arm(DragBody body) { return body == DragBody::kLeftHand || body == DragBody::kRightHand; }

// The link that a joint of this role carries; the trunk without such a joint.
std::size_t link_behind(const MotionRobot& robot, JointRole role) {
  const auto joint = robot.model.model.find(role);
  return joint ? static_cast<std::size_t>(robot.description->joints[*joint].child) : 0;
}

std::size_t link_of(const MotionRobot& robot, DragBody body) {
  switch (body) {
    case DragBody::kTrunk:
      return 0;
    case DragBody::kLeftFoot:
      return link_behind(robot, JointRole::kLeftAnkleRoll);
    case DragBody::kRightFoot:
      return link_behind(robot, JointRole::kRightAnkleRoll);
    case DragBody::kLeftHand:
      return link_behind(robot, JointRole::kLeftElbow);
    case DragBody::kRightHand:
      return link_behind(robot, JointRole::kRightElbow);
  }
  return 0;
}

}  // namespace

DragReach::DragReach(const MotionRobot& robot, std::span<const double> angles_rad, const Dragged& dragged,
                     const Vector3d& grabbed_B_m, std::uint32_t joints)
    : robot_(robot),
      dragged_(dragged),
      tree_(sim_board::hinge_tree(*robot.description)),
      start_rad_(angles_rad.begin(), angles_rad.end()),
      link_(link_of(robot, dragged.body)),
      feet_{link_of(robot, DragBody::kLeftFoot), link_of(robot, DragBody::kRightFoot)},
      grabbed_B_m_(grabbed_B_m) {
  if (dragged.support == DragSupport::kRightFoot) std::swap(feet_[0], feet_[1]);
  for (std::size_t joint = 0; joint < start_rad_.size(); ++joint)
    if ((joints >> joint & 1U) != 0) joints_.push_back(joint);
  const auto limits = [&](fixed::Angle robot::Joint::*which) {
    VectorXd values(joints_.size());
    for (std::size_t i = 0; i < joints_.size(); ++i)
      values[static_cast<Eigen::Index>(i)] = fixed::to_double(robot_.model.model.joints[joints_[i]].*which);
    return values;
  };
  bounds_ = {limits(&robot::Joint::lower), limits(&robot::Joint::upper)};
  const Links links = tree_.poses(Isometry3d::Identity(), start_rad_);
  X_BBody_ = links[link_];
  X_BSupport_ = links[feet_[0]];
  X_SupportOther_ = links[feet_[0]].inverse() * links[feet_[1]];
}

VectorXd DragReach::variables(std::span<const double> angles_rad) const {
  VectorXd q(joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) q[static_cast<Eigen::Index>(i)] = angles_rad[joints_[i]];
  return q.cwiseMax(bounds_.lower).cwiseMin(bounds_.upper);
}

std::vector<double> DragReach::with_variables(const VectorXd& q) const {
  std::vector<double> angles_rad = start_rad_;
  for (std::size_t i = 0; i < joints_.size(); ++i) angles_rad[joints_[i]] = q[static_cast<Eigen::Index>(i)];
  return angles_rad;
}

// The dragged body in axes of the trunk as it was at the start; the trunk, as its support sees it.
Isometry3d DragReach::moved_body(const Links& links) const {
  return dragged_.body == DragBody::kTrunk ? Isometry3d(X_BSupport_ * links[feet_[0]].inverse())
                                           : links[link_];
}

VectorXd DragReach::soles_error_m(const Links& links) const {
  const Isometry3d X = X_SupportOther_.inverse() * links[feet_[0]].inverse() * links[feet_[1]];
  VectorXd error(6);
  error << X.translation(), kLever_m * rotation_vector(X.linear());
  return error;
}

mechanics::Residuals DragReach::residuals(const Vector3d& displacement_B_m, const Vector3d& rotation_B_rad,
                                          std::span<const double> angles_rad) const {
  const Links links = tree_.poses(Isometry3d::Identity(), angles_rad);
  const Isometry3d X_BNow = moved_body(links);
  const Vector3d place_m = X_BNow * (X_BBody_.inverse() * grabbed_B_m_) - grabbed_B_m_ - displacement_B_m;
  if (is_arm(dragged_.body)) return {VectorXd(0), place_m};
  const Vector3d turn_m =
      kLever_m *
      rotation_vector(X_BNow.linear() * (matrix_of(rotation_B_rad) * X_BBody_.linear()).transpose());
  mechanics::Residuals result{turn_m, place_m};
  if (rotates(displacement_B_m, rotation_B_rad)) std::swap(result.hard, result.soft);
  if (dragged_.body == DragBody::kTrunk && dragged_.support == DragSupport::kBothFeet) {
    VectorXd hard(9);
    hard << result.hard, soles_error_m(links);
    result.hard = hard;
  }
  return result;
}

// Whether the rotation is to come near to its target, and the grabbed point is kept.
bool DragReach::rotates(const Vector3d& displacement_B_m, const Vector3d& rotation_B_rad) const {
  return !is_arm(dragged_.body) && displacement_B_m.isZero() && !rotation_B_rad.isZero();
}

DragReach::Missing DragReach::missing(const Vector3d& displacement_B_m, const Vector3d& rotation_B_rad,
                                      std::span<const double> angles_rad) const {
  const double soft_m = residuals(displacement_B_m, rotation_B_rad, angles_rad).soft.norm();
  if (rotates(displacement_B_m, rotation_B_rad)) return {.rad = soft_m / kLever_m};
  return {.m = soft_m};
}

std::vector<double> DragReach::nearest(const Vector3d& displacement_B_m, const Vector3d& rotation_B_rad,
                                       std::span<const double> from) const {
  std::vector<VectorXd> starts{variables(from)};
  if (is_arm(dragged_.body))
    for (const double share : kStarts)
      starts.emplace_back(bounds_.lower + share * (bounds_.upper - bounds_.lower));
  using mechanics::Residuals;
  Residuals left = residuals(displacement_B_m, rotation_B_rad, from);
  mechanics::BoundedLeastSquares solver(joints_.size(), static_cast<std::size_t>(left.hard.size()),
                                        static_cast<std::size_t>(left.soft.size()));
  const auto function = [&](const VectorXd& q, Residuals& result) {
    result = residuals(displacement_B_m, rotation_B_rad, with_variables(q));
  };
  std::vector<double> best;
  double best_m = std::numeric_limits<double>::infinity();
  for (VectorXd& q : starts) {
    solver.minimise(function, bounds_, q);
    function(q, left);
    if (left.hard.norm() > kKept_m || left.soft.norm() >= best_m - kNearer_m) continue;
    best_m = left.soft.norm();
    best = with_variables(q);
  }
  return best;
}

}  // namespace koboshi::studio
