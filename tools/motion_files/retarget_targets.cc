#include "tools/motion_files/retarget_targets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "firmware/robot/leg.h"
#include "simulation/model/isometry.h"
#include "simulation/motion_language/parse/body_targets.h"
#include "tools/motion_files/retarget.h"

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using fixed::Angle;
using robot::JointRole;
using simulation::BodyTargets;
using simulation::isometry_of;
using simulation::midway;
using simulation::rpy_of;
using simulation::vector_of;

// Soles in one plane differ by less, in lengths of the leg: by hand, above what rounded angles of key frames
// differ by, and below the height of a step.
constexpr double kPlane = 0.015;
constexpr double kParallel_rad = 3.0 * std::numbers::pi / 180.0;
// A robot stands whose hips are higher than this above its soles, in lengths of the leg, and whose centre of
// mass is not farther beside them than that.
constexpr double kLowest = 0.35;
constexpr double kFarthest = 0.6;
constexpr double kLowering = 0.01;  // of the height of the hips, in each attempt
constexpr int kMostLowerings = 20;
// An elbow that is bent by less is straight: by hand, above what rounded angles differ by.
constexpr double kStraight_rad = 2.0 * std::numbers::pi / 180.0;
constexpr double kThere_m =
    1e-4;  // a hand this close to its target stays: the last bits of a straight arm are free
constexpr double kBent_rad = 20.0 * std::numbers::pi / 180.0;  // with which the solver begins

// The proportions of a robot, and where its parts are in a pose.
class Figure {
 public:
  Figure(const std::filesystem::path& file, const simulation::NamedModel& robot) : robot_(robot) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (!robot::make_leg_geometry(robot.model, static_cast<hal::Side>(side), legs_[side]))
        throw InputError(file, 0, robot.robot + ", which has no legs that the firmware knows",
                         "a robot with legs");
    }
    const std::vector<Angle> zero(robot.model.joint_count);
    place(zero);
    leg_m = -(sole_B(0).translation() - hips_B()).z();
    hip_width_m = std::abs(sole_B(0).translation().y() - sole_B(1).translation().y());
    for (std::size_t side = 0; side < 2; ++side) {
      const auto hand = hand_B(side);
      const auto shoulder = shoulder_B(side);
      if (hand && shoulder) arm_m[side] = (*hand - *shoulder).norm();
    }
  }

  void place(std::span<const Angle> angles) {
    robot::forward_kinematics(robot_.model, angles, X_BLinks_);
    com_B = vector_of(robot::centre_of_mass(robot_.model, X_BLinks_));
  }

  Isometry3d sole_B(std::size_t side) const {
    return isometry_of(robot::sole_pose(robot_.model, static_cast<hal::Side>(side), X_BLinks_));
  }
  Vector3d hips_B() const { return simulation::hip_centre_B(legs_); }
  // From here to the hand it is as far as the elbow alone decides.
  std::optional<Vector3d> shoulder_B(std::size_t side) const {
    auto joint = robot_.model.find(side == 0 ? JointRole::kLeftShoulderRoll : JointRole::kRightShoulderRoll);
    if (!joint)
      joint = robot_.model.find(side == 0 ? JointRole::kLeftShoulderPitch : JointRole::kRightShoulderPitch);
    if (!joint) return std::nullopt;
    return vector_of(X_BLinks_[*joint].p);
  }
  std::optional<Vector3d> hand_B(std::size_t side) const {
    const auto joint = robot_.model.find(side == 0 ? JointRole::kLeftElbow : JointRole::kRightElbow);
    if (!joint || !robot_.hands[side]) return std::nullopt;
    return isometry_of(X_BLinks_[*joint]) * vector_of(*robot_.hands[side]);
  }
  // The middle of a sole in its frame, and half of its length and width.
  Vector3d sole_middle(std::size_t side) const {
    const robot::Foot& foot = robot_.model.feet[static_cast<hal::Side>(side)];
    return {0.5 * (fixed::to_double(foot.front) + fixed::to_double(foot.back)),
            0.5 * (fixed::to_double(foot.left) + fixed::to_double(foot.right)), 0.0};
  }
  Vector3d sole_half(std::size_t side) const {
    const robot::Foot& foot = robot_.model.feet[static_cast<hal::Side>(side)];
    return {0.5 * (fixed::to_double(foot.front) - fixed::to_double(foot.back)),
            0.5 * (fixed::to_double(foot.left) - fixed::to_double(foot.right)), 0.0};
  }
  const simulation::NamedModel& robot() const { return robot_; }

  double leg_m = 0.0;
  double hip_width_m = 0.0;       // between parallel feet at joint angles zero
  std::array<double, 2> arm_m{};  // from the shoulder to the tip of the hand at joint angles zero; 0: no hand
  Vector3d com_B = Vector3d::Zero();

 private:
  const simulation::NamedModel& robot_;
  std::array<robot::LegGeometry, 2> legs_{};
  robot::LinkPoses X_BLinks_{};
};

// Midway between the soles, with axes that are the mean of theirs, or the frame of one sole.
Isometry3d support_frame(const Figure& figure, BodyTargets::Support support) {
  if (support == BodyTargets::Support::kLeft) return figure.sole_B(0);
  if (support == BodyTargets::Support::kRight) return figure.sole_B(1);
  return midway(figure.sole_B(0), figure.sole_B(1));
}

class Retargeter {
 public:
  Retargeter(const std::filesystem::path& file, const ForeignMotion& motion, const RetargetRobot& from,
             const RetargetRobot& to)
      : map_(retarget_joints(file, motion, from.description, to.description, true)),
        from_(file, from.model),
        to_(file, to.model),
        scale_(to_.leg_m / from_.leg_m),
        angles_(from.model.model.joint_count),
        result_angles_(to.model.model.joint_count) {
    result_ = motion;
    result_.joints.clear();
    for (const std::string& name : to.model.joint_names) result_.joints.push_back({.name = name});
    result_.notes.insert(result_.notes.end(), map_.notes.begin(), map_.notes.end());
  }

  ForeignMotion run() {
    for (ForeignSection& section : result_.sections) {
      for (ForeignFrame& frame : section.frames) retarget(frame);
    }
    if (lying_ > 0)
      note(fmt::format("{} of {} poses, in which the robot does not stand on its soles, by joint angles",
                       lying_, frames_));
    if (lowered_ > 0)
      note(fmt::format("hips lowered in {} of {} poses, at most by {:.0f} %, because the legs do not reach",
                       lowered_, frames_, 100.0 * kLowering * most_lowered_));
    if (unreached_legs_ > 0)
      note(fmt::format("legs by joint angles in {} of {} poses, because they do not reach", unreached_legs_,
                       frames_));
    if (missed_hands_ > 0)
      note(fmt::format("hands as close as they reach in {} of {} poses, at most {:.0f} mm off", missed_hands_,
                       frames_, most_missed_m_ * kMmPerM));
    return std::move(result_);
  }

 private:
  void note(std::string text) { result_.notes.push_back({"retarget", std::move(text)}); }

  void retarget(ForeignFrame& frame) {
    ++frames_;
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      if (!frame.values[i]) continue;
      angles_[i] = fixed::from_double<Angle>(*frame.values[i]);
      given_ |= 1u << i;
    }
    from_.place(angles_);
    std::uint32_t moved = by_roles();
    if (!moves_legs() || stands()) {
      moved |= reach_targets();
    } else {
      ++lying_;
    }
    frame.values.assign(result_angles_.size(), std::nullopt);
    for (std::size_t i = 0; i < result_angles_.size(); ++i) {
      if ((moved >> i & 1u) != 0) frame.values[i] = fixed::to_double(result_angles_[i]);
    }
    std::vector<std::size_t> limp;
    for (const std::size_t joint : frame.without_torque) {
      if (map_.joints[joint]) limp.push_back(map_.joints[joint]->joint);
    }
    frame.without_torque = std::move(limp);
  }

  // A motion that has not moved the legs, or an arm, leaves them to others, such as a walk.
  bool moves_legs() const { return (given_ & from_.robot().model.leg_joints()) != 0; }
  bool moves_arm(std::size_t side) const { return (given_ & arm_joints(from_, side)) != 0; }

  static std::uint32_t arm_joints(const Figure& figure, std::size_t side) {
    const JointRole first = side == 0 ? JointRole::kLeftShoulderPitch : JointRole::kRightShoulderPitch;
    std::uint32_t joints = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (const auto joint =
              figure.robot().model.find(static_cast<JointRole>(static_cast<std::size_t>(first) + i)))
        joints |= 1u << *joint;
    }
    return joints;
  }

  // Twice, because arms that move shift the centre of mass. Returns the joints of `to` that have targets.
  std::uint32_t reach_targets() {
    std::uint32_t moved = moves_legs() ? to_.robot().model.leg_joints() : 0;
    std::optional<int> lowerings = 0;
    std::array<double, 2> missed_m{};
    for (int round = 0; round < 2; ++round) {
      if (moves_legs()) lowerings = solve_legs();
      for (std::size_t side = 0; side < 2; ++side) {
        if (!moves_arm(side)) continue;
        missed_m[side] = solve_hand(side);
        moved |= arm_joints(to_, side);
      }
    }
    const double most_m = std::max(missed_m[0], missed_m[1]);
    unreached_legs_ += lowerings ? 0 : 1;
    lowered_ += lowerings.value_or(0) > 0 ? 1 : 0;
    most_lowered_ = std::max(most_lowered_, lowerings.value_or(0));
    missed_hands_ += most_m > 0.0 ? 1 : 0;
    most_missed_m_ = std::max(most_missed_m_, most_m);
    return moved;
  }

  // Returns the joints of `to` that got an angle.
  std::uint32_t by_roles() {
    std::uint32_t moved = 0;
    const robot::RobotModel& model = to_.robot().model;
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      if (!map_.joints[i] || (given_ >> i & 1u) == 0) continue;
      const MappedJoint& mapped = *map_.joints[i];
      moved |= 1u << mapped.joint;
      result_angles_[mapped.joint] = robot::clamp_to_limits(
          model.joints[mapped.joint], fixed::from_double<Angle>(mapped.sign * fixed::to_double(angles_[i])));
    }
    return moved;
  }

  // Finds the feet that carry. Returns whether the robot stands on them.
  bool stands() {
    const Isometry3d left_B = from_.sole_B(0);
    const Isometry3d right_B = from_.sole_B(1);
    const Vector3d up = midway(left_B, right_B).linear().col(2);
    const double rise_m = (left_B.translation() - right_B.translation()).dot(up);
    const double tilt_rad =
        std::acos(std::clamp(left_B.linear().col(2).dot(right_B.linear().col(2)), -1.0, 1.0));
    if (std::abs(rise_m) < kPlane * from_.leg_m && tilt_rad < kParallel_rad) {
      support_ = BodyTargets::Support::kBoth;
    } else {
      const auto beside_m = [&](const Isometry3d& X_BS) {
        return (X_BS.inverse() * from_.com_B).head<2>().norm();
      };
      support_ =
          beside_m(left_B) < beside_m(right_B) ? BodyTargets::Support::kLeft : BodyTargets::Support::kRight;
    }
    const Isometry3d X_SB = support_frame(from_, support_).inverse();
    return (X_SB * from_.hips_B()).z() > kLowest * from_.leg_m &&
           (X_SB * from_.com_B).head<2>().norm() < kFarthest * from_.leg_m;
  }

  // Place of a foot or its counterpart in the support frame: forward and up by the legs, to the side by the
  // hips, as far as the feet are apart there, and by the legs beyond.
  Vector3d scaled(const Vector3d& p_S, double parallel_from_m, double parallel_to_m) const {
    return {scale_ * p_S.x(), parallel_to_m + scale_ * (p_S.y() - parallel_from_m), scale_ * p_S.z()};
  }

  // Returns by how many steps it lowered the hips; nothing if the legs do not reach.
  std::optional<int> solve_legs() {
    const Isometry3d X_SB = support_frame(from_, support_).inverse();
    BodyTargets targets;
    targets.support = support_;
    for (std::size_t side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1.0 : -1.0;
      const double share = support_ == BodyTargets::Support::kBoth                    ? 0.5
                           : (support_ == BodyTargets::Support::kLeft) == (side == 0) ? 0.0
                                                                                      : 1.0;
      const Isometry3d X_SSole = X_SB * from_.sole_B(side);
      targets.feet[side] = reachable(
          scaled(X_SSole.translation(), sign * share * from_.hip_width_m, sign * share * to_.hip_width_m),
          rpy_of(X_SSole.linear()));
    }
    const Vector3d hips_S = X_SB * from_.hips_B();
    const Vector3d com_S = com_target(X_SB * from_.com_B);
    const Vector3d trunk_rpy = rpy_of(X_SB.linear());
    for (int lowering = 0; lowering <= kMostLowerings; ++lowering) {
      const double height_m = scale_ * hips_S.z() * (1.0 - kLowering * lowering);
      targets.trunk = reachable({scale_ * hips_S.x(), scale_ * hips_S.y(), height_m}, trunk_rpy);
      targets.com.position_m = {com_S.x(), com_S.y(), std::nullopt};
      simulation::BodySolution solution = simulation::solve_targets(to_.robot(), targets, result_angles_);
      if (!solution.unreached.empty()) continue;
      result_angles_ = std::move(solution.angles);
      return lowering;
    }
    return std::nullopt;
  }

  // Where the centre of mass is within the rectangle of the feet that carry: in the middle in the middle, at
  // an edge at the edge.
  Vector3d com_target(const Vector3d& com_S) const {
    const auto span = [&](const Figure& figure) {
      std::pair<Vector3d, Vector3d> middle_and_half;
      if (support_ == BodyTargets::Support::kBoth) {
        middle_and_half.first = 0.5 * (figure.sole_middle(0) + figure.sole_middle(1));
        middle_and_half.second = figure.sole_half(0);
        middle_and_half.second.y() += 0.5 * figure.hip_width_m;
      } else {
        const std::size_t side = support_ == BodyTargets::Support::kLeft ? 0 : 1;
        middle_and_half = {figure.sole_middle(side), figure.sole_half(side)};
      }
      return middle_and_half;
    };
    const auto [middle_from, half_from] = span(from_);
    const auto [middle_to, half_to] = span(to_);
    Vector3d com = com_S;
    for (const Eigen::Index axis : {0, 1})
      com[axis] = middle_to[axis] + (com_S[axis] - middle_from[axis]) * half_to[axis] / half_from[axis];
    return com;
  }

  // A robot without hip yaw keeps the headings of its feet, and so does one with one motor for both.
  simulation::Target reachable(const Vector3d& p, const Vector3d& rpy) const {
    simulation::Target target = simulation::target_of(p, rpy);
    const robot::RobotModel& model = to_.robot().model;
    if (!model.find_hinge(JointRole::kLeftHipYaw) || robot::shared_yaw(model)) target.rpy_rad[2].reset();
    return target;
  }

  // A stretched arm can bend both ways, and the solver would take either. It begins with an elbow that is
  // bent as on the first robot, or else forward.
  void bend_elbow(std::size_t side) {
    const auto joint = to_.robot().model.find(side == 0 ? JointRole::kLeftElbow : JointRole::kRightElbow);
    if (!joint) return;
    Angle& elbow = result_angles_[*joint];
    const double angle_rad = fixed::to_double(elbow);
    if (std::abs(angle_rad) >= kBent_rad) return;
    const auto hand_x_m = [&](double rad) {
      elbow = robot::clamp_to_limits(to_.robot().model.joints[*joint], fixed::from_double<Angle>(rad));
      to_.place(result_angles_);
      return to_.hand_B(side)->x();
    };
    const bool is_straight = std::abs(angle_rad) < kStraight_rad;
    const bool bends_up = is_straight ? hand_x_m(kBent_rad) > hand_x_m(-kBent_rad) : angle_rad > 0.0;
    static_cast<void>(hand_x_m(bends_up ? kBent_rad : -kBent_rad));
  }

  // Returns the distance that is left, in m; 0: the hand is there, or has no target.
  double solve_hand(std::size_t side) {
    const auto hand_B = from_.hand_B(side);
    const auto shoulder_B = from_.shoulder_B(side);
    if (!hand_B || !shoulder_B || from_.arm_m[side] == 0.0 || to_.arm_m[side] == 0.0) return 0.0;
    const auto target_B = [&] {
      to_.place(result_angles_);
      return Vector3d(*to_.shoulder_B(side) + to_.arm_m[side] / from_.arm_m[side] * (*hand_B - *shoulder_B));
    };
    if ((target_B() - *to_.hand_B(side)).norm() < kThere_m) return 0.0;
    bend_elbow(side);
    const Vector3d p_B = target_B();
    const Vector3d target_S = support_frame(to_, support_).inverse() * p_B;
    BodyTargets targets;
    targets.support = support_;
    targets.hands[side].position_m = {target_S.x(), target_S.y(), target_S.z()};
    simulation::BodySolution solution = simulation::solve_targets(to_.robot(), targets, result_angles_);
    result_angles_ = std::move(solution.angles);
    return solution.unreached.empty() ? 0.0 : solution.missing_m;
  }

  JointMap map_;
  Figure from_;
  Figure to_;
  double scale_;
  std::uint32_t given_ = 0;           // joints of `from` that the motion has moved so far
  std::vector<Angle> angles_;         // of `from`
  std::vector<Angle> result_angles_;  // of `to`
  BodyTargets::Support support_ = BodyTargets::Support::kBoth;
  ForeignMotion result_;
  int frames_ = 0;
  int lying_ = 0;
  int lowered_ = 0;
  int most_lowered_ = 0;
  int unreached_legs_ = 0;
  int missed_hands_ = 0;
  double most_missed_m_ = 0.0;
};

}  // namespace

ForeignMotion retarget_targets(const std::filesystem::path& file, const ForeignMotion& motion,
                               const RetargetRobot& from, const RetargetRobot& to) {
  return Retargeter(file, motion, from, to).run();
}

}  // namespace koboshi::tools
