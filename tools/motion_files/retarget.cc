#include "tools/motion_files/retarget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "base/text/error.h"

namespace koboshi::tools {
namespace {

constexpr double kSameAxis = std::numbers::sqrt2 / 2.0;  // cosine of the angle between the axes of one role

bool moves(const ForeignMotion& motion, std::size_t joint) {
  return std::ranges::any_of(motion.sections, [&](const ForeignSection& section) {
    return std::ranges::any_of(section.frames, [&](const ForeignFrame& frame) {
      return (frame.values[joint] && *frame.values[joint] != 0.0) ||
             std::ranges::find(frame.without_torque, joint) != frame.without_torque.end();
    });
  });
}

bool is_of_leg(const std::string& role) {
  constexpr std::array<std::string_view, 3> kLeg{"hip", "knee", "ankle"};
  return std::ranges::any_of(kLeg,
                             [&](std::string_view part) { return role.find(part) != std::string::npos; });
}

}  // namespace

JointMap retarget_joints(const std::filesystem::path& file, const ForeignMotion& motion,
                         const sim_board::RobotDescription& from, const sim_board::RobotDescription& to,
                         bool legs_have_targets) {
  JointMap map;
  map.joints.resize(from.joints.size());
  std::string dropped;
  std::string reversed;
  for (std::size_t i = 0; i < from.joints.size(); ++i) {
    const sim_board::JointDescription& own = from.joints[i];
    const auto found =
        std::ranges::find_if(to.joints, [&](const auto& joint) { return joint.role() == own.role(); });
    if (found == to.joints.end()) {
      if (!moves(motion, i)) continue;
      if (is_of_leg(own.role()) && legs_have_targets) continue;
      if (is_of_leg(own.role()))
        throw InputError(file, 0, own.role() + ", which " + to.name + " does not have",
                         "a motion of joints that both robots have");
      dropped += (dropped.empty() ? "" : ", ") + own.role();
      continue;
    }
    const double cosine = own.axis_M.dot(found->axis_M);
    if (std::abs(cosine) < kSameAxis)
      throw InputError(file, 0, own.role() + ", whose axis has another direction in " + to.name,
                       "axes at most 45 degrees apart");
    if (cosine < 0.0) reversed += (reversed.empty() ? "" : ", ") + own.role();
    map.joints[i] =
        MappedJoint{static_cast<std::size_t>(found - to.joints.begin()), cosine < 0.0 ? -1.0 : 1.0};
  }
  if (!dropped.empty())
    map.notes.push_back({"joints", "dropped, because " + to.name + " has none of this role: " + dropped});
  if (!reversed.empty())
    map.notes.push_back({"joints", "turn the other way in " + to.name + ": " + reversed});
  return map;
}

}  // namespace koboshi::tools
