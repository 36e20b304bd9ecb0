#include "sim_board/engine/ode/hinge_chains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace koboshi::sim_board {
namespace {

constexpr std::size_t kMaxHinges = 3;
constexpr double kSamePlace_m = 1e-6;
constexpr double kPerpendicular = 1e-6;  // maximum cosine between perpendicular axes

const JointDescription& joint_of(const RobotDescription& robot, int joint) {
  return robot.joints.at(static_cast<std::size_t>(joint));
}
const LinkDescription& link_of(const RobotDescription& robot, int link) {
  return robot.links.at(static_cast<std::size_t>(link));
}

bool carries_sensor(const RobotDescription& robot, int link) { return robot.imu && robot.imu->link == link; }

// Returns the child joint of a link that only connects two hinges, otherwise -1.
int only_joint_behind(const RobotDescription& robot, int link) {
  if (!link_of(robot, link).collisions.empty() || carries_sensor(robot, link)) return -1;
  int behind = -1;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    if (robot.joints[j].parent != link) continue;
    if (behind >= 0) return -1;
    behind = static_cast<int>(j);
  }
  return behind;
}

bool perpendicular(const JointDescription& one, const JointDescription& other) {
  return std::abs(one.axis_M.dot(other.axis_M)) < kPerpendicular;
}

// Beyond a quarter turn of the middle hinge, the outer axes become parallel on the way (gimbal lock).
bool passes_gimbal_lock(const JointDescription& middle) {
  constexpr double kQuarterTurn_rad = std::numbers::pi / 2.0 + 1e-6;
  return middle.lower_rad < -kQuarterTurn_rad || middle.upper_rad > kQuarterTurn_rad;
}

bool fits(const RobotDescription& robot, const HingeChain& chain, int next) {
  if (next < 0 || chain.joints.size() == kMaxHinges) return false;
  if (chain.joints.size() == 2 && passes_gimbal_lock(joint_of(robot, chain.joints[1]))) return false;
  const JointDescription& joint = joint_of(robot, next);
  return std::ranges::all_of(chain.joints, [&](int before) {
    return perpendicular(joint_of(robot, before), joint) &&
           (joint_of(robot, before).p_MJ - joint.p_MJ).norm() < kSamePlace_m;
  });
}

// Returns a bound of the error of a link's pose, as mass times displacement (kg m), over the range of the
// hinge between the link and its carrier.
double misplacement(const LinkDescription& link, const JointDescription& hinge) {
  const Eigen::Vector3d p_JCom_M = link.X_ML * link.p_LCom_L - hinge.p_MJ;
  const double arm_m = p_JCom_M.cross(hinge.axis_M).norm();
  return link.mass_kg * arm_m * std::min(hinge.upper_rad - hinge.lower_rad, std::numbers::pi);
}

// Each link between the hinges moves relative to its carrier by all hinges between the two.
std::size_t best_cut(const RobotDescription& robot, const HingeChain& chain) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t cut = 0; cut < chain.joints.size(); ++cut) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < chain.joints.size(); ++i) {
      const LinkDescription& link = link_of(robot, joint_of(robot, chain.joints[i]).child);
      const std::size_t first = i < cut ? 0 : i + 1;
      const std::size_t last = i < cut ? i : chain.joints.size() - 1;
      for (std::size_t j = first; j <= last; ++j) sum += misplacement(link, joint_of(robot, chain.joints[j]));
    }
    if (sum < least) {
      least = sum;
      best = cut;
    }
  }
  return best;
}

}  // namespace

std::vector<HingeChain> single_hinges(const mechanics::HingeTree& tree) {
  std::vector<HingeChain> chains;
  for (const std::size_t joint : tree.hinges_from_root())
    chains.push_back({.joints = {static_cast<int>(joint)}});
  return chains;
}

std::vector<HingeChain> lumped_hinges(const RobotDescription& robot, const mechanics::HingeTree& tree) {
  std::vector<HingeChain> chains;
  std::vector<bool> taken(robot.joints.size(), false);
  for (const std::size_t first : tree.hinges_from_root()) {
    if (taken[first]) continue;
    HingeChain chain{.joints = {static_cast<int>(first)}};
    for (int next = only_joint_behind(robot, robot.joints[first].child); fits(robot, chain, next);
         next = only_joint_behind(robot, joint_of(robot, next).child)) {
      chain.joints.push_back(next);
    }
    for (const int joint : chain.joints) taken[static_cast<std::size_t>(joint)] = true;
    chain.cut = best_cut(robot, chain);
    chains.push_back(chain);
  }
  return chains;
}

}  // namespace koboshi::sim_board
