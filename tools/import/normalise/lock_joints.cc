#include "tools/import/normalise/lock_joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/import/normalise/followers.h"
#include "tools/import/normalise/merge_links.h"

namespace koboshi::tools {
namespace {

// A range for a joint without limits. The encoder measures a turn, so half a turn to either side is too much.
constexpr double kContinuous_deg = 175.0;

bool is_wanted(const Interview& interview, const std::string& joint) {
  return std::ranges::any_of(interview.given().joints,
                             [&](const auto& entry) { return entry.second == joint; });
}

// `is_listed`: import.yaml lists the joint, also one that it did not lock before.
void lock(ImportedJoint& joint, const std::string& because, bool is_listed, Interview& interview,
          ImportReport& report) {
  const auto given = interview.given().locked_deg.find(joint.name);
  const double angle_deg = given == interview.given().locked_deg.end() ? 0.0 : given->second;
  if (joint.kind != JointKind::kOther) {
    lock_joint(joint, kRadPerDegree * angle_deg);
  } else {
    joint.kind = JointKind::kFixed;
  }
  if (is_listed || given != interview.given().locked_deg.end())
    interview.taken.locked_deg[joint.name] = angle_deg;
  report.normalised.push_back(fmt::format("line {}: joint {} is locked at {:g} deg, because {}", joint.line,
                                          one_line(joint.name), angle_deg, because));
}

// Why a joint has no drive; nothing for one that may have one.
std::optional<std::string> undriven(const ImportedJoint& joint, bool has_actuators,
                                    const Interview& interview) {
  if (joint.kind == JointKind::kOther) return "it is " + one_line(joint.kind_name) + ", no hinge";
  if (is_wanted(interview, joint.name)) return std::nullopt;
  if (!joint.mimics.empty()) return "it mimics " + one_line(joint.mimics);
  if (has_actuators && !joint.has_actuator) return "no actuator drives it";
  if (joint.kind == JointKind::kHinge && *joint.upper_rad - *joint.lower_rad < 1e-3)
    return "its range is empty";
  if (interview.given().locked_deg.contains(joint.name)) return "import.yaml locks it";
  return std::nullopt;
}

bool is_continuous(const ImportedJoint& joint) { return joint.kind == JointKind::kContinuous; }

void set_range(ImportedJoint& joint, double range_deg, ImportReport& report) {
  joint.upper_rad = kRadPerDegree * range_deg;
  joint.lower_rad = -*joint.upper_rad;
  report.normalised.push_back(fmt::format("line {}: joint {} without limits -> {:g} deg to either side",
                                          joint.line, one_line(joint.name), range_deg));
}

}  // namespace

void lock_undriven_joints(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  const bool has_actuators = std::ranges::any_of(robot.joints, &ImportedJoint::has_actuator);
  decide_followers(robot, interview, report);
  const auto leads = [&](const ImportedJoint& joint) {
    return std::ranges::any_of(robot.joints, [&](const ImportedJoint& other) {
      return other.is_follower && other.mimics == joint.name;
    });
  };
  for (ImportedJoint& joint : robot.joints) {
    if (joint.kind == JointKind::kFixed) continue;
    if (joint.kind == JointKind::kOther && is_wanted(interview, joint.name))
      throw InputError(
          robot.file, joint.line,
          "the " + one_line(joint.kind_name) + " joint " + one_line(joint.name) + " in joints of import.yaml",
          "a hinge; the simulation has no other joints");
    if (!joint.mimics.empty() && !robot.find_joint(joint.mimics))
      report.warnings.push_back(fmt::format("line {}: joint {} mimics {}, which does not exist", joint.line,
                                            one_line(joint.name), one_line(joint.mimics)));
    // A motor that the file gives to neither of two joints turns both.
    const bool is_coupled = joint.is_follower || leads(joint);
    if (const auto because = is_coupled ? std::nullopt : undriven(joint, has_actuators, interview)) {
      lock(joint, *because, true, interview, report);
      continue;
    }
    if (is_continuous(joint)) set_range(joint, kContinuous_deg, report);
  }
}

void limit_continuous_joints(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  if (std::ranges::none_of(robot.joints, &is_continuous)) return;
  const double range_deg =
      interview.number({"continuous_range_deg",
                        "How far may joints without limits turn to either side, in degrees?",
                        number_text(kContinuous_deg),
                        {}},
                       1.0, kContinuous_deg);
  for (ImportedJoint& joint : robot.joints) {
    if (!is_continuous(joint)) continue;
    joint.kind = JointKind::kHinge;
    if (range_deg != kContinuous_deg) set_range(joint, range_deg, report);
  }
}

void lock_extra_joints(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  lock_other_followers(robot, interview, report);
  std::vector<ImportedJoint*> extra;
  std::string names;
  for (ImportedJoint& joint : robot.joints) {
    if (joint.kind == JointKind::kFixed) continue;
    const bool has_role = std::ranges::any_of(
        interview.taken.joints, [&joint](const auto& entry) { return entry.second == joint.name; });
    if (has_role) continue;
    extra.push_back(&joint);
    names += (names.empty() ? "" : ", ") + utf8_line(joint.name);
  }
  if (extra.empty()) return;
  // A robot of which no joint has a role is no humanoid, and keeps its joints.
  const std::string preset = interview.taken.joints.empty() ? "no" : "yes";
  const bool lock_them = interview.yes(
      {"lock_other_joints", "Lock the joints that the firmware has no name for: " + names + "?", preset, {}});
  if (!lock_them) return;
  for (ImportedJoint* const joint : extra)
    lock(*joint, "the firmware has no name for it", false, interview, report);
}

}  // namespace koboshi::tools
