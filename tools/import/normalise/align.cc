#include "tools/import/normalise/align.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/normalise/anchors.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

constexpr double kSnap_rad = 0.5 * kRadPerDegree;

// Names of the joints in robot.sdf, by joint of the source. A joint without a decision keeps its name, as far
// as robot.sdf permits it.
std::vector<std::string> joint_names(const ImportedRobot& robot, const ImportDecisions& decisions) {
  std::map<std::string, std::string> by_source;
  for (const auto& [name, source] : decisions.joints) by_source[source] = name;
  std::vector<std::string> names;
  for (const ImportedJoint& joint : robot.joints) {
    const auto found = by_source.find(joint.name);
    names.push_back(found == by_source.end() ? utf8_line(joint.name) : found->second);
  }
  return names;
}

// Turns the axis of a joint to one of the base where it is near one. Returns the axis.
Vector3d snapped_axis(const std::string& name, const Vector3d& axis_M, ImportReport& report) {
  int index = 0;
  axis_M.cwiseAbs().maxCoeff(&index);
  const Vector3d exact = (axis_M[index] < 0.0 ? -1.0 : 1.0) * Vector3d::Unit(index);
  const double miss_rad = std::atan2(axis_M.cross(exact).norm(), axis_M.dot(exact));
  if (miss_rad > kSnap_rad) {
    if (find_role(name) != nullptr)
      report.warnings.push_back(fmt::format("{}: its axis is {:.2f} deg beside an axis of the base", name,
                                            kDegreesPerRad * miss_rad));
    return axis_M;
  }
  if (miss_rad > 1e-9)
    report.normalised.push_back(
        fmt::format("{}: axis turned by {:.2g} deg", name, kDegreesPerRad * miss_rad));
  return exact;
}

// The joint turns the other way: its angle changes sign, and the drive's shaft does not.
void flip(ImportedJoint& joint) {
  joint.axis_L = -joint.axis_L;
  joint.drive_sign = -joint.drive_sign;
  std::swap(joint.lower_rad, joint.upper_rad);
  joint.lower_rad = -*joint.lower_rad;
  joint.upper_rad = -*joint.upper_rad;
}

// The shaft shows the source's angle. Where that leaves the encoder's turn, the middle of the range is at the
// middle of the turn instead.
void set_shaft(ImportedJoint& joint, double zero_rad) {
  constexpr double kHalfTurn_rad = std::numbers::pi - 1e-3;
  const double middle_rad = 0.5 * (*joint.lower_rad + *joint.upper_rad);
  const double half_rad = 0.5 * (*joint.upper_rad - *joint.lower_rad);
  const double room_rad = std::max(0.0, kHalfTurn_rad - half_rad);
  const double shaft_rad = std::clamp(joint.drive_sign * middle_rad + zero_rad, -room_rad, room_rad);
  joint.drive_zero_rad = shaft_rad - joint.drive_sign * middle_rad;
}

// Angles of the source are drive_sign * angle + zero here; so is the law of a follower.
void follow(const ImportedRobot& source, const std::vector<double>& zero_rad, std::size_t follower,
            ImportedRobot& aligned) {
  ImportedJoint& joint = aligned.joints[follower];
  const auto leader = static_cast<std::size_t>(*source.find_joint(joint.mimics));
  joint.mimic_offset_rad =
      joint.drive_sign * (joint.mimic_ratio * zero_rad[leader] + joint.mimic_offset_rad - zero_rad[follower]);
  joint.mimic_ratio *= joint.drive_sign * aligned.joints[leader].drive_sign;
}

// Limits of the source from the new zero, within half a turn.
void set_limits(ImportedJoint& joint, double zero_rad, ImportReport& report) {
  constexpr double kMax_rad = 179.0 * kRadPerDegree;
  const double lower_rad = std::clamp(*joint.lower_rad - zero_rad, -kMax_rad, kMax_rad - 0.01);
  const double upper_rad = std::clamp(*joint.upper_rad - zero_rad, lower_rad + 0.01, kMax_rad);
  if (lower_rad > 0.0 || upper_rad < 0.0)
    report.warnings.push_back(
        fmt::format("line {}: {}: joint zero is outside of its range", joint.line, one_line(joint.name)));
  joint.lower_rad = lower_rad;
  joint.upper_rad = upper_rad;
}

void move_content(ImportedLink& link, const Eigen::Isometry3d& X) {
  for (auto* shapes : {&link.visuals, &link.collisions})
    for (ImportedShape& shape : *shapes) shape.X_LG = X * shape.X_LG;
  for (ImportedFrame& frame : link.frames) frame.X_LF = X * frame.X_LF;
  link.p_LCom_L = X * link.p_LCom_L;
  link.I_LCom_L = X.linear() * link.I_LCom_L * X.linear().transpose();
}

// A name that no link, joint or frame has yet; all three share one name space.
std::string new_name(const std::string& wanted, std::set<std::string>& names) {
  std::string name = wanted.empty() ? "part" : wanted;
  if (name.starts_with("__") || name == "world") name = "part_" + name;  // SDF reserves these
  const std::string free = name;
  for (int i = 2; !names.insert(name).second; ++i) name = free + "_" + std::to_string(i);
  return name;
}

// The thigh is what the last joint of the hip moves, and the foot what the last of the ankle does, whatever
// their order.
std::string link_name(const ImportedRobot& robot, const std::vector<std::string>& joint_names, int joint) {
  const std::string& name = joint_names[static_cast<std::size_t>(joint)];
  const RoleJoint* const role = find_role(name);
  const auto place = std::ranges::find(kLegRoles, role == nullptr ? "" : role->name, &RoleJoint::name);
  if (place == kLegRoles.end() || place->name == "knee") return link_name_of(name);
  const std::string side = name.substr(0, name.size() - role->name.size());
  const bool is_hip = role->name.starts_with("hip_");
  const auto is_of_group = [&](const std::string& other) {
    const RoleJoint* const found = find_role(other);
    return found != nullptr && other.starts_with(side) && found->name.starts_with(is_hip ? "hip_" : "ankle_");
  };
  const int child = robot.joints[static_cast<std::size_t>(joint)].child;
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (is_of_group(joint_names[i]) && robot.joints[i].parent == child)
      return is_hip ? name + "_link" : side + "ankle_link";
  return side + (is_hip ? "thigh" : "foot");
}

void rename(ImportedRobot& robot, const std::vector<std::string>& joint_names) {
  std::set<std::string> names;
  std::map<std::string, std::string> new_names;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const std::string name = new_name(joint_names[i], names);
    new_names[std::exchange(robot.joints[i].name, name)] = name;
  }
  for (ImportedJoint& joint : robot.joints)
    if (joint.is_follower) joint.mimics = new_names.at(joint.mimics);
  const int root = root_link(robot);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const int joint = joint_of(robot, static_cast<int>(i));
    robot.links[i].name =
        new_name(static_cast<int>(i) == root ? "trunk" : link_name(robot, joint_names, joint), names);
  }
  for (ImportedLink& link : robot.links)
    for (ImportedFrame& frame : link.frames) frame.name = new_name(utf8_line(frame.name), names);
}

// Asks only where a millimetre, which covers rounding in CAD, is not enough.
double decide_max_miss_mm(JointAnchors anchors, Interview& interview) {
  constexpr double kUsual_mm = 1.0;
  ImportReport trial;
  static_cast<void>(align_anchors(anchors, kUsual_mm / kMmPerM, trial));
  if (trial.warnings.empty()) return kUsual_mm;
  return interview.number(
      {"max_miss_mm",
       "By how many millimetres may axes miss each other that are meant to meet? " + trial.warnings.front(),
       number_text(kUsual_mm),
       {}},
      0.0, 20.0);
}

}  // namespace

ImportedRobot align_robot(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR,
                          const std::vector<double>& angles_rad, Interview& interview, ImportReport& report) {
  ImportedRobot aligned = robot;
  const std::vector<std::string> names = joint_names(robot, interview.taken);
  std::vector<Eigen::Isometry3d> X_ML = link_poses(robot, angles_rad);
  for (Eigen::Isometry3d& pose : X_ML) pose = R_MR * pose;
  JointAnchors anchors;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    ImportedJoint& joint = aligned.joints[i];
    const Eigen::Isometry3d& pose = X_ML[static_cast<std::size_t>(joint.child)];
    joint.axis_L = snapped_axis(names[i], pose.linear() * joint.axis_L, report);
    set_limits(joint, angles_rad[i], report);
    const RoleJoint* const role = find_role(names[i]);
    if (role != nullptr && joint.axis_L[role->axis - 'x'] < 0.0) flip(joint);
    set_shaft(joint, angles_rad[i]);
    anchors.names.push_back(names[i]);
    anchors.axes.push_back(joint.axis_L);
    anchors.points_m.emplace_back(pose.translation());
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].is_follower) follow(robot, angles_rad, i, aligned);
  const double max_miss_mm = decide_max_miss_mm(anchors, interview);
  const Vector3d p_MB = align_anchors(anchors, max_miss_mm / kMmPerM, report);

  std::vector<Vector3d> p_BL(robot.links.size(), Vector3d::Zero());  // origins of the links
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    p_BL[static_cast<std::size_t>(robot.joints[i].child)] = anchors.points_m[i];
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    move_content(aligned.links[i], Eigen::Translation3d(-p_BL[i] - p_MB) * X_ML[i]);
  for (ImportedJoint& joint : aligned.joints)
    joint.X_PL = Eigen::Translation3d(p_BL[static_cast<std::size_t>(joint.child)] -
                                      p_BL[static_cast<std::size_t>(joint.parent)]);
  rename(aligned, names);
  return aligned;
}

}  // namespace koboshi::tools
