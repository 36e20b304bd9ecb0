#include "simulation/motion_language/parse/body_targets.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "firmware/robot/leg.h"
#include "mechanics/point_reach.h"
#include "simulation/model/isometry.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using fixed::Angle;
using fixed::to_double;
using robot::JointRole;
using Support = BodyTargets::Support;

constexpr int kMaxCorrections = 60;
// Residuals that count as reached: half of the change that one step of a 12 bit encoder makes at the foot.
constexpr double kReached_m = 2e-4;
constexpr double kReached_rad = 1e-3;
constexpr double kConverged_m = 2e-6;
constexpr std::size_t kArmJoints = 3;

robot::Pose fixed_pose(const Isometry3d& X) {
  robot::Pose pose;
  const auto ratio = [](double value) { return fixed::from_double<fixed::Ratio>(value); };
  const auto length = [](double value) { return fixed::from_double<fixed::Length>(value); };
  for (int row = 0; row < 3; ++row) {
    pose.R.rows[static_cast<std::size_t>(row)] = {ratio(X.linear()(row, 0)), ratio(X.linear()(row, 1)),
                                                  ratio(X.linear()(row, 2))};
  }
  pose.p = {length(X.translation().x()), length(X.translation().y()), length(X.translation().z())};
  return pose;
}

Matrix3d rotation_of(const Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

Isometry3d with_target(const Isometry3d& X, const Target& target) {
  Vector3d p = X.translation();
  Vector3d rpy = rpy_of(X.linear());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<Eigen::Index>(axis);
    if (target.position_m[axis]) p[index] = *target.position_m[axis];
    if (target.rpy_rad[axis]) rpy[index] = *target.rpy_rad[axis];
  }
  Isometry3d result = Isometry3d::Identity();
  result.linear() = rotation_of(rpy);
  result.translation() = p;
  return result;
}

// The chain from the trunk to the tip of a hand. The three joints of the arm reach for a target; joints
// between them and below them, as a waist, stay where they are.
class Arm {
 public:
  Arm(const NamedModel& robot, std::size_t side) : model_(robot.model) {
    const auto first =
        static_cast<std::size_t>(side == 0 ? JointRole::kLeftShoulderPitch : JointRole::kRightShoulderPitch);
    std::optional<std::size_t> elbow;
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      elbow = model_.find(static_cast<JointRole>(first + i));
      if (!elbow) return;
      joints_.push_back(*elbow);
    }
    for (int link = static_cast<int>(*elbow); link >= 0; link = model_.joints[path_.back()].parent.raw())
      path_.push_back(static_cast<std::size_t>(link));
    std::ranges::reverse(path_);
    if (path_.size() > mechanics::PointChain::kMaxHinges || !robot.hands[side]) return;
    for (const std::size_t joint : path_) {
      const robot::Joint& hinge = model_.joints[joint];
      chain_.hinges.push_back({.anchor_P = vector_of(hinge.anchor),
                               .axis_P = vector_of(hinge.axis),
                               .lower_rad = to_double(hinge.lower),
                               .upper_rad = to_double(hinge.upper)});
    }
    chain_.tip = vector_of(*robot.hands[side]);
    is_complete_ = true;
  }

  bool is_complete() const { return is_complete_; }
  std::span<const std::size_t> joints() const { return joints_; }

  Vector3d tip_B(std::span<const Angle> angles) const { return chain_.tip_at(positions_rad(angles)); }

  // Moves the arm's angles towards the target; returns the distance that is left.
  double reach(const Vector3d& target_B, std::span<Angle> angles) const {
    std::vector<double> best = positions_rad(angles);
    mechanics::PointChain chain = chain_;
    for (std::size_t i = 0; i < path_.size(); ++i)
      if (!is_of_arm(i)) chain.hinges[i].lower_rad = chain.hinges[i].upper_rad = best[i];
    double distance_m = mechanics::reach_point(chain, target_B, best);
    // Other poses of the arm, where the first leads into a limit.
    for (const double share : {0.5, 0.25, 0.75}) {
      if (distance_m < kReached_m) break;
      std::vector<double> q = best;
      for (std::size_t i = 0; i < q.size(); ++i)
        q[i] = std::lerp(chain.hinges[i].lower_rad, chain.hinges[i].upper_rad, share);
      const double other_m = mechanics::reach_point(chain, target_B, q);
      if (other_m >= distance_m) continue;
      distance_m = other_m;
      best = q;
    }
    for (std::size_t i = 0; i < path_.size(); ++i)
      if (is_of_arm(i))
        angles[path_[i]] =
            robot::clamp_to_limits(model_.joints[path_[i]], fixed::from_double<Angle>(best[i]));
    return distance_m;
  }

 private:
  bool is_of_arm(std::size_t place) const {
    return std::ranges::find(joints_, path_[place]) != joints_.end();
  }

  std::vector<double> positions_rad(std::span<const Angle> angles) const {
    std::vector<double> q;
    for (const std::size_t joint : path_) q.push_back(to_double(angles[joint]));
    return q;
  }

  const robot::RobotModel& model_;
  std::vector<std::size_t> joints_;
  std::vector<std::size_t> path_;  // from the trunk to the elbow
  mechanics::PointChain chain_;    // of the path
  bool is_complete_ = false;
};

class BodySolver {
 public:
  BodySolver(const NamedModel& robot, const BodyTargets& targets, std::span<const Angle> angles)
      : robot_(robot), targets_(targets), arms_{Arm(robot, 0), Arm(robot, 1)} {
    result_.angles.assign(angles.begin(), angles.end());
  }

  BodySolution solve() {
    place_frames();
    for (int round = 0; round < kMaxCorrections; ++round) {
      solve_legs();
      solve_arms();
      if (!correct_com()) break;
    }
    // After the last correction, which may be one of the position in the quantisation of the angles.
    solve_legs();
    solve_arms();
    report();
    return std::move(result_);
  }

 private:
  void place_frames() {
    robot::LinkPoses X_BLinks;
    robot::forward_kinematics(robot_.model, result_.angles, X_BLinks);
    std::array<Isometry3d, 2> X_BSoles;
    for (std::size_t side = 0; side < 2; ++side) {
      const auto which = static_cast<hal::Side>(side);
      X_BSoles[side] = isometry_of(robot::sole_pose(robot_.model, which, X_BLinks));
      legs_ok_ = robot::make_leg_geometry(robot_.model, which, legs_[side]) && legs_ok_;
    }
    hip_centre_B_ = hip_centre_B(legs_);
    const Isometry3d X_BS = targets_.support == Support::kLeft    ? X_BSoles[0]
                            : targets_.support == Support::kRight ? X_BSoles[1]
                                                                  : midway(X_BSoles[0], X_BSoles[1]);
    const Isometry3d X_SB = X_BS.inverse();
    for (std::size_t side = 0; side < 2; ++side) {
      X_SSoles_[side] = X_SB * X_BSoles[side];
      if (targets_.feet[side].is_given()) X_SSoles_[side] = with_target(X_SSoles_[side], targets_.feet[side]);
    }
    X_SHip_ = X_SB * Eigen::Translation3d(hip_centre_B_);
    if (targets_.trunk.is_given()) X_SHip_ = with_target(X_SHip_, targets_.trunk);
  }

  Isometry3d X_SB() const { return X_SHip_ * Eigen::Translation3d(-hip_centre_B_); }

  void solve_legs() {
    if (!targets_.moves_legs()) return;
    for (std::size_t side = 0; side < 2; ++side) {
      const Isometry3d X_BSole = X_SB().inverse() * X_SSoles_[side];
      // One motor for both hip yaws stays where it is.
      const fixed::Angle yaw =
          legs_[side].shares_yaw ? result_.angles[legs_[side].joints[robot::kHipYaw]] : fixed::Angle();
      const robot::LegAngles leg = robot::leg_inverse_kinematics(
          robot_.model, legs_[side], fixed_pose(X_BSole), nullptr, robot::FirstSolution::kAtOnce, yaw);
      for (const robot::LegJoint i : legs_[side].chain()) {
        result_.angles[legs_[side].joints[i]] = leg.angles[i];
        result_.joints |= 1u << legs_[side].joints[i];
      }
    }
  }

  void solve_arms() {
    for (std::size_t side = 0; side < 2; ++side) {
      if (!targets_.hands[side].is_given() || !arms_[side].is_complete()) continue;
      const Isometry3d now = X_SB() * Eigen::Translation3d(arms_[side].tip_B(result_.angles));
      if (!hand_targets_S_[side])
        hand_targets_S_[side] = with_target(now, targets_.hands[side]).translation();
      hand_missing_m_[side] = arms_[side].reach(X_SB().inverse() * *hand_targets_S_[side], result_.angles);
      for (const std::size_t joint : arms_[side].joints()) result_.joints |= 1u << joint;
    }
  }

  Vector3d com_error() const {
    robot::LinkPoses X_BLinks;
    robot::forward_kinematics(robot_.model, result_.angles, X_BLinks);
    const Vector3d com = X_SB() * vector_of(robot::centre_of_mass(robot_.model, X_BLinks));
    Vector3d error = Vector3d::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<Eigen::Index>(axis);
      if (targets_.com.position_m[axis]) error[index] = *targets_.com.position_m[axis] - com[index];
    }
    return error;
  }

  // Moves the trunk by the error of the centre of mass, which follows it nearly one to one. Returns whether
  // another round is needed.
  bool correct_com() {
    if (!targets_.com.is_given()) return false;
    const Vector3d error = com_error();
    if (error.norm() < kConverged_m || error.norm() > 10.0) return false;
    X_SHip_.translation() += error;
    return true;
  }

  void fail(const std::string& target, double missing_m, double missing_rad = 0.0) {
    if (!result_.unreached.empty()) return;
    result_.unreached = target;
    result_.missing_m = missing_m;
    result_.missing_rad = missing_rad;
  }

  void report() {
    robot::LinkPoses X_BLinks;
    robot::forward_kinematics(robot_.model, result_.angles, X_BLinks);
    for (std::size_t side = 0; side < 2 && targets_.moves_legs(); ++side) {
      const Isometry3d X_SSole =
          X_SB() * isometry_of(robot::sole_pose(robot_.model, static_cast<hal::Side>(side), X_BLinks));
      const double missing_m = (X_SSole.translation() - X_SSoles_[side].translation()).norm();
      const double missing_rad =
          Eigen::AngleAxisd(Matrix3d(X_SSole.linear().transpose() * X_SSoles_[side].linear())).angle();
      if (missing_m > kReached_m || missing_rad > kReached_rad || !legs_ok_) {
        fail(side == 0 ? "left_foot" : "right_foot", missing_m, missing_rad);
      }
    }
    if (targets_.com.is_given() && com_error().norm() > kReached_m) fail("com", com_error().norm());
    for (std::size_t side = 0; side < 2; ++side) {
      if (!targets_.hands[side].is_given()) continue;
      const std::string name = side == 0 ? "left_hand" : "right_hand";
      if (!arms_[side].is_complete()) fail(name, std::numeric_limits<double>::infinity());
      if (hand_missing_m_[side] > kReached_m) fail(name, hand_missing_m_[side]);
    }
  }

  const NamedModel& robot_;
  const BodyTargets& targets_;
  std::array<Arm, 2> arms_;
  std::array<robot::LegGeometry, 2> legs_{};
  bool legs_ok_ = true;
  Vector3d hip_centre_B_ = Vector3d::Zero();
  Isometry3d X_SHip_ = Isometry3d::Identity();  // the trunk's axes in the centre between the hips
  std::array<Isometry3d, 2> X_SSoles_{Isometry3d::Identity(), Isometry3d::Identity()};
  std::array<std::optional<Vector3d>, 2> hand_targets_S_{};
  std::array<double, 2> hand_missing_m_{};
  BodySolution result_;
};

}  // namespace

bool Target::is_given() const {
  const auto has_value = [](const std::optional<double>& value) { return value.has_value(); };
  return std::any_of(position_m.begin(), position_m.end(), has_value) ||
         std::any_of(rpy_rad.begin(), rpy_rad.end(), has_value);
}

Target target_of(const Vector3d& position_m, const Vector3d& rpy_rad) {
  return {.position_m = {position_m.x(), position_m.y(), position_m.z()},
          .rpy_rad = {rpy_rad.x(), rpy_rad.y(), rpy_rad.z()}};
}

Target target_of(const Isometry3d& X) { return target_of(X.translation(), rpy_of(X.linear())); }

bool BodyTargets::moves_legs() const {
  return trunk.is_given() || com.is_given() || feet[0].is_given() || feet[1].is_given();
}

BodySolution solve_targets(const NamedModel& robot, const BodyTargets& targets,
                           std::span<const Angle> angles) {
  return BodySolver(robot, targets, angles).solve();
}

}  // namespace koboshi::simulation
