#include "sim_board/description/description.h"

#include <algorithm>
#include <array>

#include "sim_board/description/schema/roles.h"

namespace koboshi::sim_board {
namespace {

template <class Part>
std::optional<int> find_named(const std::vector<Part>& parts, const std::string& name) {
  const auto place =
      std::find_if(parts.begin(), parts.end(), [&](const Part& part) { return part.name == name; });
  if (place == parts.end()) return std::nullopt;
  return static_cast<int>(place - parts.begin());
}

template <class Part>
std::vector<std::string> names_of(const std::vector<Part>& parts) {
  std::vector<std::string> names;
  for (const Part& part : parts) names.push_back(part.name);
  return names;
}

}  // namespace

std::vector<std::string> RobotDescription::joint_names() const { return names_of(joints); }

std::vector<std::string> RobotDescription::link_names() const { return names_of(links); }

double RobotDescription::total_mass_kg() const {
  double mass_kg = 0.0;
  for (const LinkDescription& link : links) mass_kg += link.mass_kg;
  return mass_kg;
}

std::vector<double> RobotDescription::hinge_positions_rad(std::vector<double> positions_rad) const {
  for (const FollowerDescription& follower : followers)
    positions_rad.push_back(
        follower.position_rad(positions_rad.at(static_cast<std::size_t>(follower.leader))));
  return positions_rad;
}

const FollowerDescription* RobotDescription::mirrored_follower(int joint) const {
  const std::string partner = other_side(joints.at(static_cast<std::size_t>(joint)).role());
  const auto found = std::ranges::find_if(followers, [&](const FollowerDescription& follower) {
    return follower.leader == joint && follower.hinge.role() == partner;
  });
  return found == followers.end() ? nullptr : &*found;
}

std::optional<int> RobotDescription::find_joint(const std::string& name_or_role) const {
  if (const auto named = find_named(joints, name_or_role)) return named;
  const auto place = std::ranges::find(joints, name_or_role, &JointDescription::role);
  if (place == joints.end()) return std::nullopt;
  return static_cast<int>(place - joints.begin());
}

int RobotDescription::mirror_of(int joint) const {
  const JointDescription& described = joints.at(static_cast<std::size_t>(joint));
  const std::string& stated = described.stated_mirror;
  return find_joint(stated.empty() ? other_side(described.role()) : stated).value_or(joint);
}

std::optional<int> RobotDescription::foot_joint(hal::Side side) const {
  const std::string prefix = side == hal::Side::kLeft ? "left_" : "right_";
  const auto in_leg = [&](const JointDescription& joint) {
    constexpr std::array kLeg{"hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll"};
    return std::ranges::any_of(kLeg, [&](const char* name) { return joint.role() == prefix + name; });
  };
  const auto depth = [&](const JointDescription& joint) {
    int links = 0;
    for (int link = joint.parent; link > 0 && links <= static_cast<int>(hinge_count()); ++links) {
      std::size_t carrier = 0;
      while (carrier < hinge_count() && hinge(carrier).child != link) ++carrier;
      link = carrier == hinge_count() ? 0 : hinge(carrier).parent;
    }
    return links;
  };
  std::optional<int> foot;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!in_leg(joints[i])) continue;
    if (!foot || depth(joints[i]) > depth(joints[static_cast<std::size_t>(*foot)]))
      foot = static_cast<int>(i);
  }
  return foot;
}

std::optional<int> RobotDescription::find_link(const std::string& link_name) const {
  return find_named(links, link_name);
}

std::vector<MirroredJoint> RobotDescription::find_joints(const std::string& joint_name) const {
  if (const auto joint = find_joint(joint_name)) return {{*joint}};
  const auto left = find_joint("left_" + joint_name);
  const auto right = find_joint("right_" + joint_name);
  if (left && !right && mirrored_follower(*left) != nullptr) return {{*left}};
  if (!left || !right) return {};
  const Eigen::Vector3d mirrored_M = mirrored_axis(joints[static_cast<std::size_t>(*left)].axis_M);
  const bool same = mirrored_M.dot(joints[static_cast<std::size_t>(*right)].axis_M) >= 0.0;
  return {{*left}, {*right, same ? 1 : -1}};
}

RobotDescription with_followers_as_joints(RobotDescription robot) {
  // Beyond the leader's stops, which give way by less: the follower's own must never act.
  constexpr double kMargin_rad = 0.05;
  for (FollowerDescription& follower : robot.followers) {
    const JointDescription& leader = robot.joints.at(static_cast<std::size_t>(follower.leader));
    const auto [lower_rad, upper_rad] =
        std::minmax({follower.position_rad(leader.lower_rad), follower.position_rad(leader.upper_rad)});
    follower.hinge.lower_rad = lower_rad - kMargin_rad;
    follower.hinge.upper_rad = upper_rad + kMargin_rad;
    robot.joints.push_back(follower.hinge);
  }
  robot.followers.clear();
  return robot;
}

Eigen::Vector3d mirrored_axis(const Eigen::Vector3d& axis) { return {-axis.x(), axis.y(), -axis.z()}; }

}  // namespace koboshi::sim_board
