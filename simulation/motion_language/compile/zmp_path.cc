#include "simulation/motion_language/compile/zmp_path.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "firmware/robot/leg.h"
#include "simulation/model/isometry.h"
#include "simulation/motion_language/parse/body_targets.h"
#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using fixed::Angle;

constexpr double kGravity_m_per_s2 = 9.80665;
// The longest of the short moves: a quarter of the time constant of a pendulum of 0.2 m. By hand.
constexpr double kLongest_s = 0.04;
// Rounded angles of poses may move a sole that stays where it is by this much.
constexpr double kStays_m = 0.002;

using Angles = std::vector<std::optional<Angle>>;

// A pose of the run: where the robot is, in the frame of the sole that stays.
struct Key {
  std::vector<Angle> angles;
  std::array<Isometry3d, 2> X_BSoles;
  Vector3d com_B;
};

// A point of the path.
struct Node {
  std::size_t move = 0;  // of the run
  double share = 0.0;    // of the move's time
  double time_s = 0.0;   // since the point before
  Vector2d zmp_S{0, 0};  // wanted
  Vector2d com_S{0, 0};
};

double minimum_jerk(double s) { return s * s * s * (10.0 + s * (6.0 * s - 15.0)); }

class Run {
 public:
  Run(const NamedModel& robot, MotionSource& motion, Diagnostics& diagnostics)
      : robot_(robot), motion_(motion), diagnostics_(diagnostics) {
    for (std::size_t side = 0; side < 2; ++side)
      has_legs_ =
          robot::make_leg_geometry(robot.model, static_cast<hal::Side>(side), legs_[side]) && has_legs_;
  }

  // Divides the moves, which begin at the pose `from`.
  std::vector<StepSource> divide(const Angles& from, const std::vector<StepSource>& moves) {
    moves_ = &moves;
    const std::uint32_t legs = robot_.model.leg_joints();
    for (std::size_t i = 0; i < from.size(); ++i) {
      if ((legs >> i & 1u) != 0 && !from[i])
        return refuse("path: zmp after a pose that is not known",
                      "a move of all joints of the legs before it");
    }
    if (!has_legs_) return refuse("path: zmp of a robot without legs", "another path");
    set_keys(from);
    if (!find_support())
      return refuse("path: zmp in which no sole stays on the ground", "one foot that stays where it is");
    place_nodes();
    solve_com();
    warn_of_distance();
    return steps();
  }

 private:
  std::vector<StepSource> refuse(std::string found, std::string expected) {
    diagnostics_.add({.code = code::kBadTarget,
                      .place = moves_->front().place,
                      .found = std::move(found),
                      .expected = std::move(expected)});
    return {};
  }

  void set_keys(const Angles& from) {
    std::vector<Angle> angles;
    for (const auto& angle : from) angles.push_back(angle.value_or(Angle()));
    keys_.clear();
    keys_.push_back(key_of(angles));
    for (const StepSource& move : *moves_) {
      const PoseSource& pose = motion_.poses[move.pose];
      for (std::size_t i = 0; i < pose.angles.size(); ++i) {
        if (pose.angles[i]) angles[i] = *pose.angles[i];
      }
      keys_.push_back(key_of(angles));
    }
  }

  Key key_of(const std::vector<Angle>& angles) const {
    robot::LinkPoses X_BLinks;
    robot::forward_kinematics(robot_.model, angles, X_BLinks);
    Key key{
        .angles = angles, .X_BSoles = {}, .com_B = vector_of(robot::centre_of_mass(robot_.model, X_BLinks))};
    for (std::size_t side = 0; side < 2; ++side)
      key.X_BSoles[side] =
          isometry_of(robot::sole_pose(robot_.model, static_cast<hal::Side>(side), X_BLinks));
    return key;
  }

  Isometry3d X_SB(const Key& key) const { return key.X_BSoles[support_].inverse(); }
  Isometry3d X_SOther(const Key& key) const { return X_SB(key) * key.X_BSoles[1 - support_]; }
  Vector3d com_S(const Key& key) const { return X_SB(key) * key.com_B; }

  // The sole that is never above the other one.
  bool find_support() {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      support_ = side;
      if (std::ranges::all_of(keys_,
                              [&](const Key& key) { return X_SOther(key).translation().z() > -kStays_m; }))
        return true;
    }
    return false;
  }

  void place_nodes() {
    nodes_.assign(1, {.zmp_S = com_S(keys_.front()).head<2>()});
    height_m_ = 0.0;
    for (const Key& key : keys_) height_m_ += com_S(key).z() / static_cast<double>(keys_.size());
    for (std::size_t m = 0; m < moves_->size(); ++m) {
      const Vector2d from = com_S(keys_[m]).head<2>();
      const Vector2d to = com_S(keys_[m + 1]).head<2>();
      add_nodes(m, (*moves_)[m].time_us * 1e-6, from, to);
      add_nodes(m, (*moves_)[m].pause_us * 1e-6, to, to);
    }
  }

  void add_nodes(std::size_t move, double time_s, const Vector2d& from, const Vector2d& to) {
    const bool pauses =
        from == to && !nodes_.empty() && nodes_.back().share == 1.0 && nodes_.back().move == move;
    const int count = static_cast<int>(std::ceil(time_s / kLongest_s - 1e-9));
    const auto until_us = [&](int i) { return std::llround(1e6 * time_s * i / count); };
    for (int i = 1; i <= count; ++i) {
      const double share = static_cast<double>(i) / count;
      nodes_.push_back({.move = move,
                        .share = pauses ? 1.0 : share,
                        .time_s = 1e-6 * static_cast<double>(until_us(i) - until_us(i - 1)),
                        .zmp_S = from + share * (to - from)});
    }
  }

  // The rows of Z give the ZMP of each node from the centre of mass of all; at the ends, at rest, it has no
  // speed. The inner nodes are unknown.
  void solve_com() {
    const auto count = static_cast<Eigen::Index>(nodes_.size());
    const double lag_s2 = height_m_ / kGravity_m_per_s2;
    Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd weights(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double before_s = k > 0 ? nodes_[static_cast<std::size_t>(k)].time_s : 0.0;
      const double after_s = k + 1 < count ? nodes_[static_cast<std::size_t>(k) + 1].time_s : 0.0;
      weights[k] = std::sqrt(0.5 * (before_s + after_s));
      Z(k, k) = 1.0;
      if (k > 0)
        add_acceleration(
            Z, k, k - 1,
            k + 1 < count ? 2.0 / (before_s * (before_s + after_s)) : 2.0 / (before_s * before_s), lag_s2);
      if (k + 1 < count)
        add_acceleration(Z, k, k + 1,
                         k > 0 ? 2.0 / (after_s * (before_s + after_s)) : 2.0 / (after_s * after_s), lag_s2);
    }
    Eigen::MatrixXd wanted(count, 2);
    for (Eigen::Index k = 0; k < count; ++k)
      wanted.row(k) = nodes_[static_cast<std::size_t>(k)].zmp_S.transpose();
    Eigen::MatrixXd com = wanted;  // whose ends are given
    if (count > 2) {
      const Eigen::MatrixXd ends = Z.col(0) * wanted.row(0) + Z.col(count - 1) * wanted.row(count - 1);
      const Eigen::MatrixXd A = weights.asDiagonal() * Z.middleCols(1, count - 2);
      const Eigen::MatrixXd b = weights.asDiagonal() * (wanted - ends);
      com.middleRows(1, count - 2) = (A.transpose() * A).ldlt().solve(A.transpose() * b);
    }
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      nodes_[k].com_S = com.row(static_cast<Eigen::Index>(k)).transpose();
    distance_m_ = (Z * com - wanted).rowwise().norm().maxCoeff();
  }

  // The ZMP lies behind the acceleration: factor * (other - own).
  static void add_acceleration(Eigen::MatrixXd& Z, Eigen::Index own, Eigen::Index other, double factor,
                               double lag_s2) {
    Z(own, other) -= lag_s2 * factor;
    Z(own, own) += lag_s2 * factor;
  }

  void warn_of_distance() {
    if (distance_m_ <= kZmpTolerance * height_m_) return;
    diagnostics_.add(
        {.code = code::kZmpPath,
         .severity = Severity::kWarning,
         .place = moves_->front().place,
         .found = fmt::format("a zero moment point {:.0f} mm beside its path", distance_m_ * kMmPerM),
         .expected = fmt::format("at most {:.0f} mm; slower moves follow better",
                                 kZmpTolerance * height_m_ * kMmPerM)});
  }

  std::vector<StepSource> steps() {
    std::vector<StepSource> steps;
    std::vector<Angle> angles = keys_.front().angles;
    for (std::size_t k = 1; k < nodes_.size(); ++k) {
      const Node& node = nodes_[k];
      const StepSource& move = (*moves_)[node.move];
      const BodySolution solution = solve(node, angles);
      if (!solution.unreached.empty()) {
        diagnostics_.add({.code = code::kUnreachable,
                          .place = move.place,
                          .found = fmt::format("a path of the centre of mass that the legs miss by {:.1f} mm",
                                               solution.missing_m * kMmPerM),
                          .expected = "a slower move, or hips lower"});
        return {};
      }
      angles = solution.angles;
      const PoseSource& target = motion_.poses[move.pose];
      PoseSource pose{.name = target.name, .place = target.place, .angles = Angles(angles.size())};
      for (std::size_t i = 0; i < angles.size(); ++i) {
        if (target.angles[i] || (robot_.model.leg_joints() >> i & 1u) != 0) pose.angles[i] = angles[i];
      }
      StepSource step{.kind = StepSource::Kind::kMove, .place = move.place, .pose = motion_.poses.size()};
      step.time_us = static_cast<std::uint32_t>(std::lround(node.time_s * 1e6));
      step.interpolation = motion::Interpolation::kCubic;
      motion_.poses.push_back(std::move(pose));
      steps.push_back(std::move(step));
    }
    return steps;
  }

  BodySolution solve(const Node& node, std::vector<Angle> angles) const {
    const Key& from = keys_[node.move];
    const Key& to = keys_[node.move + 1];
    const double share = minimum_jerk(node.share);
    for (std::size_t i = 0; i < angles.size(); ++i) {
      if ((robot_.model.leg_joints() >> i & 1u) != 0) continue;
      angles[i] = fixed::from_double<Angle>(
          std::lerp(fixed::to_double(from.angles[i]), fixed::to_double(to.angles[i]), share));
    }
    const auto between = [share](const Isometry3d& a, const Isometry3d& b) {
      Isometry3d X = Isometry3d::Identity();
      X.linear() = Quaterniond(a.linear()).slerp(share, Quaterniond(b.linear())).toRotationMatrix();
      X.translation() = a.translation() + share * (b.translation() - a.translation());
      return X;
    };
    BodyTargets targets;
    targets.support = support_ == 0 ? BodyTargets::Support::kLeft : BodyTargets::Support::kRight;
    targets.feet[1 - support_] = target_of(between(X_SOther(from), X_SOther(to)));
    const Isometry3d X_Hips(Eigen::Translation3d{hip_centre_B(legs_)});
    targets.trunk = target_of(between(X_SB(from) * X_Hips, X_SB(to) * X_Hips));
    targets.trunk.position_m = {std::nullopt, std::nullopt, targets.trunk.position_m[2]};
    targets.com.position_m = {node.com_S.x(), node.com_S.y(), std::nullopt};
    return solve_targets(robot_, targets, angles);
  }

  const NamedModel& robot_;
  MotionSource& motion_;
  Diagnostics& diagnostics_;
  std::array<robot::LegGeometry, 2> legs_{};
  bool has_legs_ = true;
  const std::vector<StepSource>* moves_ = nullptr;
  std::vector<Key> keys_;
  std::size_t support_ = 0;  // the side of the sole that stays
  std::vector<Node> nodes_;
  double height_m_ = 0.0;
  double distance_m_ = 0.0;  // between the ZMP and its path, at most
};

bool has_zmp_path(const std::vector<StepSource>& steps) {
  return std::ranges::any_of(steps, [](const StepSource& step) {
    return step.zmp_path || has_zmp_path(step.body) || has_zmp_path(step.otherwise);
  });
}

class Divider {
 public:
  Divider(MotionSource& motion, const NamedModel& robot, Diagnostics& diagnostics)
      : motion_(motion), robot_(robot), run_(robot, motion, diagnostics) {}

  void divide(std::vector<StepSource>& steps) {
    Angles angles(robot_.joint_names.size());
    std::vector<StepSource> divided;
    for (std::size_t i = 0; i < steps.size();) {
      if (steps[i].zmp_path) {
        std::vector<StepSource> moves;
        for (; i < steps.size() && steps[i].zmp_path; ++i) moves.push_back(steps[i]);
        for (StepSource& move : run_.divide(angles, moves)) divided.push_back(std::move(move));
        for (const StepSource& move : moves) follow(move, angles);
        continue;
      }
      StepSource& step = steps[i++];
      if (step.kind == StepSource::Kind::kMove) {
        follow(step, angles);
      } else if (!keeps_pose(step)) {
        std::ranges::fill(angles, std::nullopt);
      }
      divide(step.body);
      divide(step.otherwise);
      divided.push_back(std::move(step));
    }
    steps = std::move(divided);
  }

 private:
  void follow(const StepSource& move, Angles& angles) const {
    const Angles& pose = motion_.poses[move.pose].angles;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      if (pose[i]) angles[i] = pose[i];
    }
  }

  // Whether the robot is in the same pose after the step, by whatever way it comes there.
  static bool keeps_pose(const StepSource& step) {
    using enum StepSource::Kind;
    return step.kind == kWait || step.kind == kExpect || step.kind == kSet || step.kind == kStiffness ||
           step.kind == kGain || step.kind == kMix || step.kind == kLean;
  }

  MotionSource& motion_;
  const NamedModel& robot_;
  Run run_;
};

}  // namespace

MotionSource with_zmp_paths(const MotionSource& motion, const NamedModel& robot, Diagnostics& diagnostics) {
  MotionSource result = motion;
  const bool any =
      has_zmp_path(motion.steps) || std::ranges::any_of(motion.routines, [](const RoutineSource& routine) {
        return has_zmp_path(routine.steps);
      });
  if (!any) return result;
  Divider divider(result, robot, diagnostics);
  divider.divide(result.steps);
  for (RoutineSource& routine : result.routines) divider.divide(routine.steps);
  return result;
}

}  // namespace koboshi::simulation
