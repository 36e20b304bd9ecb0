#include "tests/unit/firmware/robot/random_leg.h"

#include <algorithm>
#include <cmath>

#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {
namespace {

using robot::Joint;
using robot::JointIndex;
using robot::JointRole;
using robot::kLegJoints;
using robot::LinkIndex;
using robot::RobotModel;

constexpr std::array<Point, 3> kUnits{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
// The axes of the standard leg, and limits in degrees about them, wide enough for any order of the joints.
constexpr std::array<Point, kLegJoints> kAxes{
    {kUnits[2], kUnits[0], kUnits[1], kUnits[1], kUnits[1], kUnits[0]}};
constexpr std::array<double, kLegJoints> kLower_deg{-90, -60, -130, -20, -100, -60};
constexpr std::array<double, kLegJoints> kUpper_deg{90, 60, 70, 150, 80, 60};

robot::Direction direction(const Point& p) {
  return {fixed::from_double<fixed::Ratio>(p.x), fixed::from_double<fixed::Ratio>(p.y),
          fixed::from_double<fixed::Ratio>(p.z)};
}

void set_leg(RobotModel& model, hal::Side side, const LegPlan& plan) {
  const auto indices = model.leg(side);
  const double mirror = side == hal::Side::kLeft ? 1.0 : -1.0;
  std::array<robot::LegJoint, kLegJoints> chain{plan.hip[0],  plan.hip[1],   plan.hip[2],
                                                robot::kKnee, plan.ankle[0], plan.ankle[1]};
  LinkIndex parent;
  for (std::size_t place = 0; place < kLegJoints; ++place) {
    const std::size_t i = chain[place];
    Joint& joint = model.joints[indices[i]];
    const Point nominal = place == 0                 ? Point{0, 0.03, 0}
                          : place == 3 || place == 4 ? Point{0, 0, -0.065}
                                                     : Point{};
    const Point anchor = nominal + plan.offsets[place];
    joint.anchor = position(anchor.x, mirror * anchor.y, anchor.z);
    // A mirrored axis is a pseudovector.
    Point axis = kAxes[i] + plan.tilts[i];
    axis = {mirror * axis.x, axis.y, mirror * axis.z};
    if (kAxes[i].y == 0) axis = mirror * axis;
    axis = (plan.reversed[i] ? -1.0 / norm(axis) : 1.0 / norm(axis)) * axis;
    joint.axis = direction(axis);
    const bool outward = kAxes[i].x != 0 && side == hal::Side::kRight;
    const double lower = outward ? -kUpper_deg[i] : kLower_deg[i];
    const double upper = outward ? -kLower_deg[i] : kUpper_deg[i];
    joint.lower = degrees(plan.reversed[i] ? -upper : lower);
    joint.upper = degrees(plan.reversed[i] ? -lower : upper);
    if (i == robot::kHipYaw && !plan.has_yaw) {
      joint.role = JointRole::kOther;  // it no longer carries the leg
      joint.parent = LinkIndex();
      continue;
    }
    joint.parent = parent;
    parent = LinkIndex(indices[i]);
  }
}

// Solves A x = b by Gauss's elimination with pivots.
std::array<double, 6> solve_linear(std::array<std::array<double, 7>, 6> A) {
  for (std::size_t j = 0; j < 6; ++j) {
    std::size_t pivot = j;
    for (std::size_t i = j; i < 6; ++i)
      if (std::abs(A[i][j]) > std::abs(A[pivot][j])) pivot = i;
    std::swap(A[j], A[pivot]);
    for (std::size_t i = 0; i < 6; ++i) {
      if (i == j) continue;
      const double factor = A[i][j] / A[j][j];
      for (std::size_t k = j; k < 7; ++k) A[i][k] -= factor * A[j][k];
    }
  }
  std::array<double, 6> x{};
  for (std::size_t j = 0; j < 6; ++j) x[j] = A[j][6] / A[j][j];
  return x;
}

double norm_of(const std::array<double, 6>& e) {
  double sum = 0.0;
  for (const double component : e) sum += component * component;
  return std::sqrt(sum);
}

}  // namespace

RobotModel make_robot_with(const LegPlan& plan) {
  RobotModel model = make_test_robot();
  set_leg(model, hal::Side::kLeft, plan);
  set_leg(model, hal::Side::kRight, plan);
  return model;
}

LegPlan draw_leg_plan(std::mt19937& random) {
  const auto uniform = [&](double limit) { return std::uniform_real_distribution<>(-limit, limit)(random); };
  LegPlan plan;
  std::ranges::shuffle(plan.hip, random);
  std::ranges::shuffle(plan.ankle, random);
  const double hip_m = std::pow(10.0, std::uniform_real_distribution<>(-4.0, std::log10(0.05))(random));
  for (std::size_t place = 1; place < kLegJoints; ++place) {
    const double limit = place < 3 ? hip_m / std::sqrt(3.0) : 0.01;
    plan.offsets[place] = {uniform(limit), uniform(limit), uniform(limit)};
  }
  for (std::size_t i = 0; i < kLegJoints; ++i) {
    plan.tilts[i] = {uniform(0.1), uniform(0.1), uniform(0.1)};
    plan.reversed[i] = random() % 2 == 0;
  }
  if (random() % 4 == 0) {  // yaw and roll turned by 45 degrees about y
    plan.tilts[robot::kHipYaw].x += -1.0;
    plan.tilts[robot::kHipRoll].z += 1.0;
  }
  return plan;
}

SolePose ReferenceLeg::pose(const Angles& angles_rad) const {
  std::array<double, robot::kMaxJoints> all_rad{};
  for (const robot::LegJoint i : leg_.chain()) all_rad[leg_.joints[i]] = angles_rad[i];
  SolePose sole{from_sole(model_, all_rad, side_, {}), {}};
  const auto foot = static_cast<int>(model_.foot_joint(side_));
  for (std::size_t axis = 0; axis < 3; ++axis)
    sole.axes[axis] = to_base(model_, all_rad, foot, kUnits[axis], true);
  return sole;
}

std::array<double, 6> ReferenceLeg::error(const Angles& angles_rad, const SolePose& target) const {
  const SolePose now = pose(angles_rad);
  const Point p = target.p - now.p;
  const auto& z = target.axes;
  // Two components of the sole's normal, and the heading, in the target's axes.
  return {p.x,
          p.y,
          p.z,
          0.1 * dot(now.axes[2], z[0]),
          0.1 * dot(now.axes[2], z[1]),
          leg_.can_turn() ? 0.1 * dot(now.axes[0], z[1]) : 0.0};
}

double ReferenceLeg::solve(const SolePose& target, Angles& angles_rad) const {
  constexpr double kStep_rad = 1e-6;
  double damping = 1e-6;
  std::array<double, 6> e = error(angles_rad, target);
  for (int step = 0; step < 60 && norm_of(e) > 1e-12; ++step) {
    std::array<std::array<double, 6>, 6> columns{};
    for (std::size_t i = 0; i < kLegJoints; ++i) {
      if (i == robot::kHipYaw && !leg_.can_turn()) continue;
      Angles ahead = angles_rad;
      Angles behind = angles_rad;
      ahead[i] += kStep_rad;
      behind[i] -= kStep_rad;
      const auto more = error(ahead, target);
      const auto less = error(behind, target);
      for (std::size_t k = 0; k < 6; ++k) columns[i][k] = (more[k] - less[k]) / (2 * kStep_rad);
    }
    std::array<std::array<double, 7>, 6> A{};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t k = 0; k < 6; ++k) A[i][j] += columns[i][k] * columns[j][k];
      A[i][i] += damping;
      for (std::size_t k = 0; k < 6; ++k) A[i][6] -= columns[i][k] * e[k];
    }
    const auto change = solve_linear(A);
    Angles next = angles_rad;
    for (std::size_t i = 0; i < 6; ++i) next[i] += change[i];
    const auto next_error = error(next, target);
    const bool better = norm_of(next_error) < norm_of(e);
    damping *= better ? 0.1 : 10.0;
    if (!better) continue;
    angles_rad = next;
    e = next_error;
  }
  return norm_of(e);
}

double ReferenceLeg::position_error_m(const Angles& angles_rad, const SolePose& target) const {
  return norm(pose(angles_rad).p - target.p);
}

double ReferenceLeg::direction_error(const Angles& angles_rad, const SolePose& target) const {
  const SolePose now = pose(angles_rad);
  double worst = norm(now.axes[2] - target.axes[2]);
  if (leg_.can_turn()) worst = std::max(worst, norm(now.axes[0] - target.axes[0]));
  return worst;
}

robot::Pose to_fixed(const SolePose& pose) {
  const robot::Rotation R_SoleB{{direction(pose.axes[0]), direction(pose.axes[1]), direction(pose.axes[2])}};
  return {robot::transpose(R_SoleB), position(pose.p.x, pose.p.y, pose.p.z)};
}

ReferenceLeg::Angles to_double(const robot::LegAngles& solution) {
  ReferenceLeg::Angles angles_rad{};
  for (std::size_t i = 0; i < kLegJoints; ++i) angles_rad[i] = fixed::to_double(solution.angles[i]);
  return angles_rad;
}

}  // namespace koboshi::test
