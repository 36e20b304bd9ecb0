#include "studio/document/pose_drag.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "firmware/robot/leg.h"
#include "simulation/model/isometry.h"
#include "simulation/motion_language/parse/body_targets.h"
#include "simulation/motion_language/parse/joints.h"

namespace koboshi::studio {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using fixed::Angle;
using fixed::to_double;
using robot::JointRole;
using simulation::isometry_of;
using simulation::target_of;
using simulation::vector_of;

// Steps of the search along the line to a target out of reach: the longest displacement and rotation between
// two neighbouring poses, in which no joint turns farther than kMaxTurn_rad unless the pose is another
// branch of the inverse kinematics. By hand.
constexpr double kStep_m = 0.01;
constexpr double kStep_rad = 0.1;
constexpr double kMaxTurn_rad = 0.6;
constexpr int kHalvings = 8;  // of the last step: 0.04 mm
// The search ends this close to a limit: 0.1 degrees.
constexpr double kAtLimit_rad = 0.002;
// Just under half a turn.
constexpr double kMaxRotation_rad = std::numbers::pi - 1e-3;
// By which the soles may move relative to each other when the trunk is dragged: half of what a user is
// promised, 0.1 mm. The tolerance of BodySolution is coarser.
constexpr double kSoles_m = 5e-5;

Matrix3d rotation_of(const Vector3d& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  if (angle_rad == 0.0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad).toRotationMatrix();
}

// The side of the limb that moves. The trunk has that of its support, and the left one on both feet.
std::size_t side_of(DragBody body, DragSupport support) {
  if (body == DragBody::kTrunk) return support == DragSupport::kRightFoot ? 1 : 0;
  return body == DragBody::kRightFoot || body == DragBody::kRightHand ? 1 : 0;
}
bool is_hand(DragBody body) { return body == DragBody::kLeftHand || body == DragBody::kRightHand; }

const char* group_of(DragBody body, DragSupport support) {
  constexpr std::array kGroups{"legs", "left_leg", "right_leg", "left_arm", "right_arm"};
  return kGroups[body == DragBody::kTrunk ? static_cast<std::size_t>(support)
                                          : static_cast<std::size_t>(body)];
}

}  // namespace

PoseDrag::PoseDrag(const MotionRobot& robot, std::span<const double> angles_rad, DragBody body,
                   const Vector3d& grabbed_B_m, DragSupport support)
    : robot_(robot),
      body_(body),
      support_(support),
      side_(side_of(body, support)),
      model_(robot.model),
      start_rad_(angles_rad.begin(), angles_rad.end()),
      grabbed_B_m_(grabbed_B_m),
      joints_(simulation::JointNames(robot.model).mask(group_of(body, support))),
      reach_(robot, angles_rad, {body, support}, grabbed_B_m, joints_) {
  const robot::RobotModel& model = model_.model;
  for (const double angle_rad : start_rad_) start_.push_back(fixed::from_double<Angle>(angle_rad));
  robot::LinkPoses X_BLinks;
  robot::forward_kinematics(model, start_, X_BLinks);
  X_BS_ = isometry_of(robot::sole_pose(model, hal::Side::kLeft, X_BLinks));
  p_SRight_m_ =
      X_BS_.inverse() * isometry_of(robot::sole_pose(model, hal::Side::kRight, X_BLinks)).translation();
  X_BSole_ = isometry_of(robot::sole_pose(model, static_cast<hal::Side>(side_), X_BLinks));
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    robot::LegGeometry leg;
    if (robot::make_leg_geometry(model, side, leg)) hip_B_m_ += 0.5 * vector_of(leg.p_BH_B);
  }
  if (!is_hand(body)) return;
  const auto elbow = model.find(body == DragBody::kLeftHand ? JointRole::kLeftElbow : JointRole::kRightElbow);
  if (!elbow) return;
  const Vector3d tip = isometry_of(X_BLinks[*elbow]).inverse() * grabbed_B_m;
  model_.hands[side_] = {fixed::from_double<fixed::Length>(tip.x()),
                         fixed::from_double<fixed::Length>(tip.y()),
                         fixed::from_double<fixed::Length>(tip.z())};
}

PoseDrag::Attempt PoseDrag::solve(const Vector3d& displacement_B_m, const Vector3d& rotation_B_rad,
                                  std::span<const Angle> from) const {
  // Moves the points of the body from the start to the target.
  Isometry3d X = Isometry3d::Identity();
  X.linear() = rotation_of(rotation_B_rad);
  X.translation() = grabbed_B_m_ + displacement_B_m - X.linear() * grabbed_B_m_;
  const Isometry3d X_SB = X_BS_.inverse();
  simulation::BodyTargets targets;
  targets.support = simulation::BodyTargets::Support::kLeft;
  std::span<const Angle> begin = start_;
  if (moves_over_both()) {
    targets.trunk = target_of(Isometry3d(X_SB * X * Eigen::Translation3d(hip_B_m_)));
  } else if (body_ == DragBody::kTrunk) {  // as the trunk sees it, its support moves the other way
    targets.feet[side_] = target_of(X_SB * X.inverse() * X_BSole_);
  } else if (is_hand(body_)) {
    begin = from;  // an iterative solution stays in the branch in which it begins
    const Vector3d p_S = X_SB * (grabbed_B_m_ + displacement_B_m);
    targets.hands[side_].position_m = {p_S.x(), p_S.y(), p_S.z()};
  } else {
    targets.feet[side_] = target_of(X_SB * X * X_BSole_);
  }
  simulation::BodySolution solution = simulation::solve_targets(model_, targets, begin);
  for (std::size_t joint = 0; joint < start_.size(); ++joint)
    if ((joints_ >> joint & 1U) == 0) solution.angles[joint] = start_[joint];
  const bool reached = solution.unreached.empty() && (!moves_over_both() || keeps_soles(solution.angles));
  return {reached, std::move(solution.angles)};
}

// Whether the right sole is where it was as the left one sees it.
bool PoseDrag::keeps_soles(std::span<const Angle> angles) const {
  robot::LinkPoses X_BLinks;
  robot::forward_kinematics(model_.model, angles, X_BLinks);
  const auto sole = [&](hal::Side side) {
    return isometry_of(robot::sole_pose(model_.model, side, X_BLinks));
  };
  const Vector3d p_S = (sole(hal::Side::kLeft).inverse() * sole(hal::Side::kRight)).translation();
  return (p_S - p_SRight_m_).norm() < kSoles_m;
}

bool PoseDrag::is_near(std::span<const Angle> one, std::span<const Angle> other) const {
  return std::ranges::equal(one, other, [](const Angle& a, const Angle& b) {
    return std::abs(to_double(a) - to_double(b)) < kMaxTurn_rad;
  });
}

// Joints that do not move keep the angles of the start to the bit.
std::vector<double> PoseDrag::angles_of(std::span<const Angle> angles) const {
  std::vector<double> angles_rad = start_rad_;
  for (std::size_t joint = 0; joint < start_rad_.size(); ++joint)
    if ((joints_ >> joint & 1U) != 0 && angles[joint] != start_[joint])
      angles_rad[joint] = to_double(angles[joint]);
  return angles_rad;
}

DraggedPose PoseDrag::result(std::vector<double> angles_rad) const {
  DraggedPose pose{.angles_rad = std::move(angles_rad)};
  for (std::size_t joint = 0; joint < start_rad_.size(); ++joint) {
    if ((joints_ >> joint & 1U) == 0) continue;
    const robot::Joint& model = robot_.model.model.joints[joint];
    const double angle_rad = pose.angles_rad[joint];
    if (angle_rad > to_double(model.upper) - kAtLimit_rad ||
        angle_rad < to_double(model.lower) + kAtLimit_rad)
      pose.at_limit.push_back(joint);
  }
  return pose;
}

// The last reachable pose on the straight line to a target out of reach: from it, the nearest one is looked
// for, so that equal targets lead to equal poses.
std::vector<double> PoseDrag::last_on_line(const Vector3d& displacement_B_m,
                                           const Vector3d& rotation_B_rad) const {
  const int steps =
      1 + static_cast<int>(std::max(displacement_B_m.norm() / kStep_m, rotation_B_rad.norm() / kStep_rad));
  Attempt best{true, start_};
  const auto advance = [&](double share) {
    Attempt next = solve(share * displacement_B_m, share * rotation_B_rad, best.angles);
    if (!next.reached || !is_near(next.angles, best.angles)) return false;
    best = std::move(next);
    return true;
  };
  double share = 0.0;
  double step = 1.0 / steps;
  while (share + step <= 1.0 && advance(share + step)) share += step;
  for (int i = 0; i < kHalvings; ++i) {
    step *= 0.5;
    if (share + step <= 1.0 && advance(share + step)) share += step;
  }
  return angles_of(best.angles);
}

// A rotation by more than half a turn has the orientation of a smaller one in the other direction, to which
// the body must not jump.
DraggedPose PoseDrag::move(const Vector3d& displacement_B_m, const Vector3d& rotation_B_rad) const {
  const double excess_rad = rotation_B_rad.norm() - kMaxRotation_rad;
  if (excess_rad > 0.0 && !is_hand(body_)) {
    DraggedPose pose = move_within(displacement_B_m, kMaxRotation_rad * rotation_B_rad.normalized());
    pose.reached = false;
    pose.missing_rad += excess_rad;
    return pose;
  }
  return move_within(displacement_B_m, is_hand(body_) ? Vector3d(Vector3d::Zero()) : rotation_B_rad);
}

DraggedPose PoseDrag::move_within(const Vector3d& displacement_B_m, const Vector3d& rotation) const {
  if (const Attempt direct = solve(displacement_B_m, rotation, start_); direct.reached)
    return result(angles_of(direct.angles));
  const std::vector<double> last = last_on_line(displacement_B_m, rotation);
  const DragReach::Missing last_missing = reach_.missing(displacement_B_m, rotation, last);
  const std::vector<double> nearest = reach_.nearest(displacement_B_m, rotation, last);
  const DragReach::Missing missing =
      nearest.empty() ? last_missing : reach_.missing(displacement_B_m, rotation, nearest);
  const bool is_nearer = missing.m + missing.rad < last_missing.m + last_missing.rad;
  DraggedPose pose = result(is_nearer ? nearest : last);
  pose.reached = false;
  pose.missing_m = (is_nearer ? missing : last_missing).m;
  pose.missing_rad = (is_nearer ? missing : last_missing).rad;
  return pose;
}

}  // namespace koboshi::studio
