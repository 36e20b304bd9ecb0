#include "tools/import/normalise/linkages.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/text/text.h"
#include "tools/import/normalise/followers.h"

namespace koboshi::tools {
namespace {

class Linkages {
 public:
  Linkages(ImportedRobot& robot, ImportReport& report) : robot_(robot), report_(report) {
    carried_kg_.assign(robot.joints.size(), 0.0);
    for (std::size_t link = 0; link < robot.links.size(); ++link)
      for (const std::size_t joint : above(static_cast<int>(link)))
        carried_kg_[joint] += robot.links[link].mass_kg;
  }

  void move_along_gears() {
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      ImportedJoint& follower = robot_.joints[i];
      const std::optional<int> found = robot_.find_joint(follower.mimics);
      if (follower.mimics.empty() || !found) continue;
      const auto leader = static_cast<std::size_t>(*found);
      const double ratio = std::abs(follower.mimic_ratio);
      if (!drives_one_of(i, leader) || ratio < kMinRatio || ratio > kMaxRatio) continue;
      const bool follower_drives = follower.has_actuator;
      if (are_limbs_of_one_motor(robot_, i, leader)) {
        if (follower_drives) exchange(i, leader);
        continue;
      }
      const std::size_t driven = follower_drives ? leader : i;
      const std::size_t driving = follower_drives ? i : leader;
      if (carried_kg_[driven] > carried_kg_[driving]) {
        move(driving, driven, follower_drives ? ratio : 1.0 / ratio);
      } else if (follower_drives) {
        robot_.joints[leader].mimics = follower.name;
        follower.mimics.clear();
      }
    }
  }

  void move_along_rods() {
    for (const ImportedLoop& loop : robot_.loops) {
      const std::vector<std::size_t> path = between(loop.one, loop.other);
      const auto drives = [this](std::size_t joint) { return robot_.joints[joint].has_actuator; };
      if (std::ranges::any_of(path, [this](std::size_t joint) { return moved_from_.contains(joint); }))
        continue;
      const auto driving = std::ranges::find_if(path, drives);
      const auto driven = heaviest_passive(path);
      if (std::ranges::count_if(path, drives) == 1 && driven &&
          carried_kg_[*driven] > carried_kg_[*driving]) {
        report_.warnings.push_back(
            fmt::format("{} moves {} through rods: the ratio is taken as 1 : 1, and the rods are locked",
                        one_line(robot_.joints[*driving].name), one_line(robot_.joints[*driven].name)));
        move(*driving, *driven, 1.0);
        continue;
      }
      report_.warnings.push_back(fmt::format("a connection of {} and {} closes a loop; it is left out",
                                             link_name(loop.one), link_name(loop.other)));
    }
  }

 private:
  static constexpr double kMinRatio = 0.02;
  static constexpr double kMaxRatio = 50.0;

  std::string link_name(int link) const {
    return one_line(robot_.links[static_cast<std::size_t>(link)].name);
  }

  // The joint with the actuator leads.
  void exchange(std::size_t follower, std::size_t leader) {
    ImportedJoint& from = robot_.joints[follower];
    ImportedJoint& to = robot_.joints[leader];
    to.mimics = from.name;
    to.mimic_ratio = 1.0 / from.mimic_ratio;
    to.mimic_offset_rad = -from.mimic_offset_rad / from.mimic_ratio;
    from.mimics.clear();
  }

  // The joints from a link to the root.
  std::vector<std::size_t> above(int link) const {
    std::vector<std::size_t> joints;
    for (int at = joint_of(robot_, link); at >= 0;
         at = joint_of(robot_, robot_.joints[static_cast<std::size_t>(at)].parent))
      joints.push_back(static_cast<std::size_t>(at));
    return joints;
  }
  // The joints that move one link against the other.
  std::vector<std::size_t> between(int one, int other) const {
    std::vector<std::size_t> path = above(one);
    for (const std::size_t joint : above(other))
      if (std::erase(path, joint) == 0) path.push_back(joint);
    return path;
  }
  bool drives_one_of(std::size_t one, std::size_t other) const {
    return robot_.joints[one].has_actuator != robot_.joints[other].has_actuator;
  }
  std::optional<std::size_t> heaviest_passive(const std::vector<std::size_t>& path) const {
    std::optional<std::size_t> best;
    for (const std::size_t index : path) {
      const ImportedJoint& joint = robot_.joints[index];
      const bool is_hinge = joint.kind == JointKind::kHinge || joint.kind == JointKind::kContinuous;
      if (!is_hinge || joint.has_actuator || !joint.mimics.empty()) continue;
      if (!best || carried_kg_[index] > carried_kg_[*best]) best = index;
    }
    return best;
  }

  // `reduction`: turns of the driving joint for one of the driven joint.
  void move(std::size_t driving, std::size_t driven, double reduction) {
    ImportedJoint& from = robot_.joints[driving];
    ImportedJoint& to = robot_.joints[driven];
    to.has_actuator = true;
    to.mimics.clear();
    to.reduction = from.reduction * reduction;
    to.has_stage = from.reduction == 1.0;
    to.rotor_inertia_kg_m2 = from.rotor_inertia_kg_m2 * reduction * reduction;
    to.coulomb_friction_Nm += from.coulomb_friction_Nm * reduction;
    if (to.effort_Nm <= 0.0) to.effort_Nm = from.effort_Nm * reduction;
    if (to.speed_rad_per_s <= 0.0) to.speed_rad_per_s = from.speed_rad_per_s / reduction;
    from.has_actuator = false;
    from.mimics = to.name;
    moved_from_.insert(driving);
    report_.normalised.push_back(fmt::format("the actuator of {} is at {}, which it drives {:.3g} : 1",
                                             one_line(from.name), one_line(to.name), reduction));
  }

  ImportedRobot& robot_;
  ImportReport& report_;
  std::vector<double> carried_kg_;    // by joint
  std::set<std::size_t> moved_from_;  // joints that had an actuator
};

}  // namespace

void move_actuators(ImportedRobot& robot, ImportReport& report) {
  Linkages linkages(robot, report);
  linkages.move_along_gears();
  linkages.move_along_rods();
}

}  // namespace koboshi::tools
