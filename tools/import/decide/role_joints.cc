#include "tools/import/decide/role_joints.h"

#include <algorithm>
#include <map>

#include "base/text/user_units.h"

namespace koboshi::tools {
namespace {

constexpr std::string_view kLeft = "left_";
constexpr std::string_view kRight = "right_";

std::string_view without_side(std::string_view name) {
  if (name.starts_with(kLeft)) return name.substr(kLeft.size());
  return name.starts_with(kRight) ? name.substr(kRight.size()) : name;
}

}  // namespace

const std::vector<std::string>& role_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    const auto add = [&all](std::string_view side, const auto& roles) {
      for (const RoleJoint& role : roles) all.push_back(std::string(side) + std::string(role.name));
    };
    add(kLeft, kLegRoles);
    add(kRight, kLegRoles);
    add(kLeft, kArmRoles);
    add(kRight, kArmRoles);
    add("", kHeadRoles);
    return all;
  }();
  return names;
}

const RoleJoint* find_role(std::string_view joint) {
  const std::string_view name = without_side(joint);
  const bool has_side = name.size() != joint.size();
  const auto find = [name](const auto& roles) -> const RoleJoint* {
    for (const RoleJoint& role : roles)
      if (role.name == name) return &role;
    return nullptr;
  };
  if (!has_side) return find(kHeadRoles);
  const RoleJoint* const leg = find(kLegRoles);
  return leg != nullptr ? leg : find(kArmRoles);
}

std::string mirrored_name(const std::string& name) {
  if (name.starts_with(kLeft)) return std::string(kRight) + name.substr(kLeft.size());
  if (name.starts_with(kRight)) return std::string(kLeft) + name.substr(kRight.size());
  return name;
}

std::string link_name_of(const std::string& joint) {
  const RoleJoint* const role = find_role(joint);
  if (role == nullptr) return joint + "_link";
  return joint.substr(0, joint.size() - role->name.size()) + std::string(role->link);
}

std::array<double, 2> usual_range_rad(const std::string& role) {
  // Degrees, in the left side's signs (docs/design/frames.md).
  static const std::map<std::string_view, std::array<double, 2>> table{
      {"hip_yaw", {-25, 25}},        {"hip_roll", {-15, 30}},    {"hip_pitch", {-90, 25}},
      {"knee", {-5, 110}},           {"ankle_pitch", {-60, 45}}, {"ankle_roll", {-25, 25}},
      {"shoulder_pitch", {-90, 60}}, {"shoulder_roll", {0, 90}}, {"elbow", {-90, 20}},
      {"head_pan", {-60, 60}},       {"head_tilt", {-25, 40}}};
  constexpr double kOther_deg = 30.0;
  const RoleJoint* const found = find_role(role);
  if (found == nullptr) return {-kOther_deg * kRadPerDegree, kOther_deg * kRadPerDegree};
  const auto& [lower_deg, upper_deg] = table.at(found->name);
  const double lower_rad = std::min(lower_deg, 0.0) * kRadPerDegree;
  const double upper_rad = std::max(upper_deg, 0.0) * kRadPerDegree;
  const bool is_mirrored = role.starts_with(kRight) && found->axis != 'y';
  return is_mirrored ? std::array{-upper_rad, -lower_rad} : std::array{lower_rad, upper_rad};
}

}  // namespace koboshi::tools
