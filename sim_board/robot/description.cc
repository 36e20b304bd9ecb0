#include "sim_board/robot/description.h"

#include <algorithm>

namespace koboshi::sim {
namespace {

template <class Part>
std::optional<int> find_named(const std::vector<Part>& parts, const std::string& name) {
  const auto place =
      std::find_if(parts.begin(), parts.end(), [&](const Part& part) { return part.name == name; });
  if (place == parts.end()) return std::nullopt;
  return static_cast<int>(place - parts.begin());
}

}  // namespace

double RobotDescription::total_mass_kg() const {
  double mass_kg = 0.0;
  for (const LinkDescription& link : links) mass_kg += link.mass_kg;
  return mass_kg;
}

std::optional<int> RobotDescription::find_joint(const std::string& joint_name) const {
  return find_named(joints, joint_name);
}

std::optional<int> RobotDescription::find_link(const std::string& link_name) const {
  return find_named(links, link_name);
}

}  // namespace koboshi::sim
