#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "base/text/text.h"
#include "sim_board/description/description.h"
#include "sim_board/description/fault_list.h"
#include "sim_board/description/load_parts.h"
#include "sim_board/description/schema/roles.h"

namespace koboshi::sim_board {
namespace {

// load_robot() normalises any axis, which would hide a mistyped digit.
void find_axis_faults(const XmlNode& xyz, FaultList& faults) {
  const std::vector<double> values = xyz.numbers();
  const double length = std::hypot(values[0], values[1], values[2]);
  if (std::abs(length - 1.0) <= 1e-4) return;
  faults.add(RobotFaultKind::kAxis, xyz,
             "<xyz> = " + one_line(xyz.text()) + ", of length " + number_text(length), "a unit vector");
}

// The encoder measures one turn: the shaft must stay within it over the joint's whole range. A limit in
// another unit, a fault of its own, says nothing about the range.
void find_range_faults(const XmlNode& joint, FaultList& faults) {
  const XmlNode limit = joint.child("axis").child("limit");
  if (faults.has_fault(limit.child("lower")) || faults.has_fault(limit.child("upper"))) return;
  const double lower_rad = limit.number("lower");
  const double upper_rad = limit.number("upper");
  if (lower_rad >= upper_rad) {
    faults.add(RobotFaultKind::kLimits, limit,
               "lower " + number_text(lower_rad) + " and upper " + number_text(upper_rad),
               "lower below upper");
  }
  if (is_follower(joint)) return;
  const XmlNode drive = joint.child("koboshi:drive");
  const auto sign = static_cast<double>(drive.attribute_integer("sign", DriveDescription().sign));
  const double zero_rad = drive.attribute_number("zero_rad", 0.0);
  for (const double limit_rad : {lower_rad, upper_rad}) {
    const double shaft_rad = sign * limit_rad + zero_rad;
    if (std::abs(shaft_rad) < std::numbers::pi) continue;
    faults.add(RobotFaultKind::kShaft, drive,
               "a shaft at " + number_text(shaft_rad) + " rad where joint " + joint.attribute("name") +
                   " is at " + number_text(limit_rad),
               "less than half a turn to either side", "zero_rad");
    return;
  }
}

// A follower has no drive, and neither a sensor that measures what a drive's joint carries.
void find_follower_faults(const XmlNode& joint, FaultList& faults) {
  constexpr double kMinMultiplier = 0.05;
  const XmlNode multiplier = joint.child("axis").child("mimic").child("multiplier");
  if (std::abs(multiplier.numbers().front()) < kMinMultiplier)
    faults.add(RobotFaultKind::kCoupling, multiplier,
               "a multiplier of " + number_text(multiplier.numbers().front()),
               "at least 0.05 or at most -0.05");
  for (const char* part : {"koboshi:servo", "koboshi:encoder", "koboshi:drive", "sensor"})
    if (const auto node = joint.find(part))
      faults.add(RobotFaultKind::kCoupling, *node,
                 "<" + std::string(part) + "> of " + joint.attribute("name") + ", which has <mimic>",
                 "that element on the joint that it follows, or no <mimic>");
}

// A joint's role, and the element that states it: <koboshi:role>, or the joint whose name it is.
struct Role {
  std::string name;
  XmlNode node;
};

Role role_of(const XmlNode& joint) {
  if (const auto stated = joint.find("koboshi:role")) return {stated->text(), *stated};
  return {joint.attribute("name"), joint};
}

// The joint of the other side as mirror_of() finds it; the joint itself if there is none.
std::string mirror_of(const XmlNode& joint, const std::map<std::string, std::string>& joints_by_role) {
  if (const auto stated = joint.find("koboshi:mirror")) return stated->text();
  const auto other = joints_by_role.find(other_side(role_of(joint).name));
  return other == joints_by_role.end() ? joint.attribute("name") : other->second;
}

}  // namespace

void find_role_faults(const XmlNode& model, FaultList& faults) {
  std::map<std::string, XmlNode> joints;
  std::set<std::int64_t> servo_ids;
  for (const XmlNode& joint : model.children("joint")) {
    joints.emplace(joint.attribute("name"), joint);
    const auto maker = joint.find("koboshi:maker");
    if (maker && !servo_ids.insert(maker->attribute_integer("servo_id")).second)
      faults.add(RobotFaultKind::kRole, *maker, "a second servo_id " + maker->attribute("servo_id"),
                 "each servo of the maker once", "servo_id");
  }
  std::map<std::string, std::string> joints_by_role;
  for (const auto& [name, joint] : joints) {
    const Role role = role_of(joint);
    const auto [first, is_new] = joints_by_role.emplace(role.name, name);
    if (!is_new) {
      const bool is_stated = joint.find("koboshi:role").has_value();
      const XmlNode& second = is_stated ? role.node : role_of(joints.at(first->second)).node;
      faults.add(RobotFaultKind::kRole, second,
                 "the role " + role.name + " of both " + first->second + " and " + name, "one joint a role");
    } else if (role.name != name && joints.contains(role.name)) {
      faults.add(RobotFaultKind::kRole, role.node, "the role " + role.name + ", the name of another joint",
                 "a role that names one joint");
    }
  }
  for (const auto& [name, joint] : joints) {
    const std::string other = mirror_of(joint, joints_by_role);
    const auto found = joints.find(other);
    if (found == joints.end()) {
      faults.add(RobotFaultKind::kRole, joint.child("koboshi:mirror"),
                 "<koboshi:mirror> = " + one_line(other), "the name of a joint");
    } else if (const std::string back = mirror_of(found->second, joints_by_role); back != name) {
      faults.add(RobotFaultKind::kRole, joint.find("koboshi:mirror").value_or(joint),
                 other + " as mirror of " + name + ", but " + back + " as mirror of " + other,
                 "two joints that mirror each other");
    }
  }
}

void find_coupling_faults(const XmlNode& model, FaultList& faults) {
  std::map<std::string, XmlNode> joints;
  for (const XmlNode& joint : faults.sound_children(model, "joint"))
    joints.emplace(joint.attribute("name"), joint);
  std::map<std::string, std::string> follower_of;
  for (const auto& [name, joint] : joints) {
    if (!is_follower(joint)) continue;
    const XmlNode mimic = joint.child("axis").child("mimic");
    const std::string leader = mimic.attribute("joint");
    const auto found = joints.find(leader);
    const bool has_drive = found != joints.end() && !is_follower(found->second);
    const auto [first, is_new] = follower_of.emplace(leader, name);
    if (!has_drive) {
      faults.add(RobotFaultKind::kCoupling, mimic, "joint = " + one_line(leader),
                 "the name of a joint with a drive", "joint");
    } else if (!is_new) {
      faults.add(RobotFaultKind::kCoupling, mimic, "joint = " + one_line(leader) + ", as of " + first->second,
                 "one follower of a joint", "joint");
    }
  }
}

void find_joint_faults(const XmlNode& joint, FaultList& faults) {
  find_axis_faults(joint.child("axis").child("xyz"), faults);
  find_range_faults(joint, faults);
  if (is_follower(joint)) find_follower_faults(joint, faults);
  for (const XmlNode& sensor : joint.children("sensor")) find_ankle_faults(sensor, faults);
}

}  // namespace koboshi::sim_board
