#include "simulation/motion_language/parse/joints.h"

#include <algorithm>
#include <array>

namespace koboshi::simulation {
namespace {

using robot::JointRole;

// A group of joints by the first and the last of their roles.
struct Group {
  std::string_view name;
  JointRole first;
  JointRole last;
};

constexpr std::array<Group, 7> kGroups{{{"head", JointRole::kHeadPan, JointRole::kHeadTilt},
                                        {"left_leg", JointRole::kLeftHipYaw, JointRole::kLeftAnkleRoll},
                                        {"right_leg", JointRole::kRightHipYaw, JointRole::kRightAnkleRoll},
                                        {"legs", JointRole::kLeftHipYaw, JointRole::kRightAnkleRoll},
                                        {"left_arm", JointRole::kLeftShoulderPitch, JointRole::kLeftElbow},
                                        {"right_arm", JointRole::kRightShoulderPitch, JointRole::kRightElbow},
                                        {"arms", JointRole::kLeftShoulderPitch, JointRole::kRightElbow}}};

}  // namespace

JointNames::JointNames(const NamedModel& robot) : robot_(robot) {}

std::optional<std::size_t> JointNames::find(std::string_view name) const {
  for (const std::vector<std::string>* names : {&robot_.joint_names, &robot_.joint_roles}) {
    const auto found = std::find(names->begin(), names->end(), name);
    if (found != names->end()) return static_cast<std::size_t>(found - names->begin());
  }
  return std::nullopt;
}

std::optional<std::size_t> JointNames::find_left(std::string_view sideless) const {
  const auto left = find("left_" + std::string(sideless));
  if (!left) return std::nullopt;
  // One motor may turn both sides, as mirror images.
  const robot::Joint& joint = robot_.model.joints[*left];
  const bool is_both =
      robot_.model.leads(robot::JointIndex(*left)) && joint.mirror == *left && joint.mirror_sign > 0;
  return is_both || find("right_" + std::string(sideless)) ? left : std::nullopt;
}

std::uint32_t JointNames::mask(std::string_view name) const {
  if (const auto joint = find(name)) return 1u << *joint;
  if (const auto left = find_left(name)) return 1u << *left | 1u << mirror(*left);
  std::uint32_t joints = 0;
  for (const Group& group : kGroups) {
    if (group.name != name) continue;
    for (std::size_t i = 0; i < count(); ++i) {
      const JointRole role = robot_.model.joints[i].role;
      if (role >= group.first && role <= group.last) joints |= 1u << i;
    }
  }
  return joints;
}

std::vector<std::string> JointNames::all(bool groups) const {
  std::vector<std::string> names = robot_.joint_names;
  for (const std::string& role : robot_.joint_roles) {
    if (std::find(names.begin(), names.end(), role) == names.end()) names.push_back(role);
  }
  const std::size_t with_side = names.size();
  for (std::size_t i = 0; i < with_side; ++i) {
    if (names[i].starts_with("left_") && find_left(names[i].substr(5))) names.push_back(names[i].substr(5));
  }
  if (groups) {
    for (const Group& group : kGroups) names.emplace_back(group.name);
  }
  return names;
}

}  // namespace koboshi::simulation
