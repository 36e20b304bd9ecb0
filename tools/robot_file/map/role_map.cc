#include "tools/robot_file/map/role_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/schema/roles.h"

namespace koboshi::tools {
namespace {

using sim_board::RobotDescription;

std::string maker_text(const sim_board::JointDescription& joint) {
  if (!joint.maker) return {};
  return fmt::format(", servo_id: {}, sign: {}, zero_ticks: {}, ticks_per_turn: {}", joint.maker->servo_id,
                     joint.maker->sign, number_text(joint.maker->zero_ticks),
                     number_text(joint.maker->ticks_per_turn));
}

}  // namespace

void correct_role(const RobotDescription& robot, const std::string& correction, RoleMap& map) {
  const std::size_t equals = correction.find('=');
  if (equals == std::string::npos)
    throw InputError(robot.file, 0, one_line(correction), "ROLE=JOINT, such as left_knee=l_knee_joint");
  const std::string role = correction.substr(0, equals);
  const std::string name = correction.substr(equals + 1);
  if (std::ranges::find(sim_board::role_names(), role) == sim_board::role_names().end())
    throw InputError(robot.file, 0, "the role " + one_line(role),
                     "a role of koboshi:role in docs/reference/robot-file.md");
  const auto joint = std::ranges::find(robot.joints, name, &sim_board::JointDescription::name);
  if (!name.empty() && joint == robot.joints.end())
    throw InputError(robot.file, 0, "the joint " + one_line(name), "the name of a joint");
  const auto without_pair = [&map](std::size_t i) {
    const std::size_t other = std::exchange(map.joints[i].mirror, i);
    map.joints[other].mirror = other;
  };
  for (std::size_t i = 0; i < map.joints.size(); ++i) {
    if (map.joints[i].role != role) continue;
    map.joints[i].role.clear();
    without_pair(i);
  }
  if (name.empty()) return;
  const auto index = static_cast<std::size_t>(joint - robot.joints.begin());
  without_pair(index);
  map.joints[index].role = role;
  const auto other = std::ranges::find(map.joints, sim_board::other_side(role), &RoleMap::Joint::role);
  if (other == map.joints.end()) return;
  map.joints[index].mirror = static_cast<std::size_t>(other - map.joints.begin());
  other->mirror = index;
}

std::string role_map_text(const RobotDescription& robot, const RoleMap& map) {
  std::string text = fmt::format("robot: {}\njoints:\n", robot.name);
  for (std::size_t i = 0; i < map.joints.size(); ++i) {
    const RoleMap::Joint& joint = map.joints[i];
    const Eigen::Vector3d& axis = robot.joints[i].axis_M;
    std::string fields = joint.role.empty() ? "role: none" : "role: " + joint.role;
    if (joint.mirror != i) fields += ", mirror: " + robot.joints[joint.mirror].name;
    text += fmt::format("  {}: {{{}{}}}  # axis ({:.2g}, {:.2g}, {:.2g}), carries {:.0f} g\n",
                        robot.joints[i].name, fields, maker_text(robot.joints[i]), axis.x() + 0.0,
                        axis.y() + 0.0, axis.z() + 0.0, 1000.0 * joint.carried_kg);
  }
  if (map.feet[0] && map.feet[1]) {
    text += fmt::format("soles: {{left: {}, right: {}}}\n",
                        robot.links[static_cast<std::size_t>(*map.feet[0])].name,
                        robot.links[static_cast<std::size_t>(*map.feet[1])].name);
  }
  if (robot.imu)
    text += fmt::format("imu: {}\n", robot.links[static_cast<std::size_t>(robot.imu->link)].name);
  return text;
}

std::vector<sim_board::ModelSetting> role_settings(const RobotDescription& robot, const RoleMap& map) {
  std::vector<sim_board::ModelSetting> settings;
  for (std::size_t i = 0; i < map.joints.size(); ++i) {
    const sim_board::JointDescription& joint = robot.joints[i];
    const RoleMap::Joint& mapped = map.joints[i];
    if (mapped.role.empty()) {
      if (!joint.stated_role.empty()) settings.push_back({joint.name + ".role", ""});
    } else if (mapped.role != joint.role()) {
      settings.push_back({joint.name + ".role", mapped.role});
    }
    // A role with a side finds its mirror by itself.
    const bool needs_mirror = mapped.role.empty() && mapped.mirror != i;
    const std::string mirror = needs_mirror ? robot.joints[mapped.mirror].name : std::string();
    const bool is_known = robot.mirror_of(static_cast<int>(i)) == static_cast<int>(mapped.mirror);
    if (needs_mirror && !is_known) settings.push_back({joint.name + ".mirror", mirror});
    if (!needs_mirror && !is_known && !joint.stated_mirror.empty())
      settings.push_back({joint.name + ".mirror", ""});
  }
  return settings;
}

}  // namespace koboshi::tools
