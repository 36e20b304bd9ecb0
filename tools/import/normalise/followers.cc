#include "tools/import/normalise/followers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/normalise/merge_links.h"

namespace koboshi::tools {
namespace {

// Range of <multiplier> in robot.sdf.
constexpr double kMinRatio = 0.05;
constexpr double kMaxRatio = 8.0;

// Whether a joint is on the way from a link to the root.
bool carries(const ImportedRobot& robot, std::size_t joint, int link) {
  for (int at = joint_of(robot, link); at >= 0;
       at = joint_of(robot, robot.joints[static_cast<std::size_t>(at)].parent))
    if (static_cast<std::size_t>(at) == joint) return true;
  return false;
}

// Counts the hinges beyond a joint that have an angle of their own.
std::size_t free_hinges_beyond(const ImportedRobot& robot, std::size_t joint) {
  return static_cast<std::size_t>(std::ranges::count_if(robot.joints, [&](const ImportedJoint& other) {
    const bool is_free =
        other.mimics.empty() && (other.kind == JointKind::kHinge || other.kind == JointKind::kContinuous);
    return is_free && carries(robot, joint, other.parent);
  }));
}

bool is_named(const Interview& interview, const std::string& joint) {
  return std::ranges::any_of(interview.given().joints,
                             [&](const auto& entry) { return entry.second == joint; });
}

std::optional<std::size_t> leader_of(const ImportedRobot& robot, const ImportedJoint& joint) {
  if (joint.mimics.empty()) return std::nullopt;
  const auto index = robot.find_joint(joint.mimics);
  return index ? std::optional(static_cast<std::size_t>(*index)) : std::nullopt;
}

void lock_one(ImportedJoint& joint, const std::string& because, Interview& interview, ImportReport& report) {
  joint.is_follower = false;
  if (joint.kind == JointKind::kFixed) return;
  lock_joint(joint, 0.0);
  interview.taken.locked_deg[joint.name] = 0.0;
  std::erase_if(interview.taken.joints, [&](const auto& entry) { return entry.second == joint.name; });
  report.normalised.push_back(fmt::format("line {}: joint {} is locked at 0 deg, because {}", joint.line,
                                          one_line(joint.name), because));
}

}  // namespace

bool are_limbs_of_one_motor(const ImportedRobot& robot, std::size_t joint, std::size_t other) {
  constexpr std::size_t kLimb = 3;
  return free_hinges_beyond(robot, joint) >= kLimb && free_hinges_beyond(robot, other) >= kLimb &&
         !carries(robot, joint, robot.joints[other].parent) &&
         !carries(robot, other, robot.joints[joint].parent);
}

void decide_followers(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  const auto is_locked = [&](const ImportedJoint& joint) {
    return interview.given().locked_deg.contains(joint.name);
  };
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    ImportedJoint& joint = robot.joints[i];
    const auto leader = leader_of(robot, joint);
    if (!leader || !are_limbs_of_one_motor(robot, i, *leader)) continue;
    ImportedJoint& other = robot.joints[*leader];
    if (is_locked(joint) || is_locked(other) || !other.mimics.empty()) continue;
    // Entries for both in `joints` of an older import.yaml gave each a motor of its own.
    const bool are_wanted = is_named(interview, joint.name) && is_named(interview, other.name);
    const bool follows = interview.yes(
        {"one_motor",
         fmt::format("One motor turns {} and {}. Does it in the simulation, too? (no: each has a motor)",
                     utf8_line(other.name), utf8_line(joint.name)),
         are_wanted ? "no" : "yes",
         {}});
    const double ratio = std::abs(joint.mimic_ratio);
    if (!follows) {
      joint.mimics.clear();
      joint.has_actuator = other.has_actuator;
    } else if (ratio < kMinRatio || ratio > kMaxRatio) {
      report.warnings.push_back(fmt::format("line {}: {} turns {:g} times as far as {}, not {} to {} times",
                                            joint.line, one_line(joint.name), ratio, one_line(other.name),
                                            kMinRatio, kMaxRatio));
    } else {
      joint.is_follower = true;
      report.normalised.push_back(
          fmt::format("line {}: {} follows {}, as {:g} times its angle{}", joint.line, one_line(joint.name),
                      one_line(other.name), joint.mimic_ratio,
                      joint.mimic_offset_rad == 0.0
                          ? ""
                          : fmt::format(" and {:.3g} deg", kDegreesPerRad * joint.mimic_offset_rad)));
    }
  }
}

void lock_other_followers(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  const auto role_of = [&](const std::string& source) {
    for (const auto& [name, joint] : interview.taken.joints)
      if (joint == source) return name;
    return std::string();
  };
  for (ImportedJoint& joint : robot.joints) {
    if (!joint.is_follower) continue;
    ImportedJoint& leader = robot.joints[static_cast<std::size_t>(*robot.find_joint(joint.mimics))];
    const std::string role = role_of(joint.name);
    if (role.ends_with("_hip_yaw") && role_of(leader.name) == mirrored_name(role)) continue;
    report.warnings.push_back(
        fmt::format("line {}: one motor turns {} and {}: both are locked, because the firmware has one motor "
                    "for two joints "
                    "only where they are both hip yaws; one_motor: no gives each a motor of its own",
                    joint.line, one_line(joint.name), one_line(leader.name)));
    lock_one(joint, "one motor turns it and " + one_line(leader.name), interview, report);
    lock_one(leader, "one motor turns it and " + one_line(joint.name), interview, report);
  }
}

void limit_followers(ImportedRobot& robot, ImportReport& report) {
  for (ImportedJoint& joint : robot.joints) {
    if (!joint.is_follower) continue;
    ImportedJoint& leader = robot.joints[static_cast<std::size_t>(*robot.find_joint(joint.mimics))];
    const auto at_leader = [&](double angle_rad) {
      return (angle_rad - joint.mimic_offset_rad) / joint.mimic_ratio;
    };
    const auto [lower_rad, upper_rad] =
        std::minmax({at_leader(*joint.lower_rad), at_leader(*joint.upper_rad)});
    if (lower_rad > *leader.lower_rad + 1e-3 || upper_rad < *leader.upper_rad - 1e-3)
      report.normalised.push_back(
          fmt::format("{}: its range ends where {}, which follows it, ends", leader.name, joint.name));
    leader.lower_rad = std::max(*leader.lower_rad, lower_rad);
    leader.upper_rad = std::max(*leader.lower_rad + 0.01, std::min(*leader.upper_rad, upper_rad));
    const auto [low_rad, high_rad] =
        std::minmax({joint.mimic_ratio * *leader.lower_rad + joint.mimic_offset_rad,
                     joint.mimic_ratio * *leader.upper_rad + joint.mimic_offset_rad});
    joint.lower_rad = low_rad;
    joint.upper_rad = high_rad;
    joint.speed_rad_per_s = std::abs(joint.mimic_ratio) * leader.speed_rad_per_s;
  }
}

}  // namespace koboshi::tools
