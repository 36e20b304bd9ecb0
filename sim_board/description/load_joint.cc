#include <algorithm>
#include <cmath>

#include "sim_board/description/load_parts.h"
#include "sim_board/description/schema/sdf_version.h"

namespace koboshi::sim_board {
namespace {

DriveDescription load_drive(const XmlNode& node) {
  DriveDescription drive;
  drive.node_id = static_cast<std::uint8_t>(node.attribute_integer("node_id"));
  drive.vendor_id = static_cast<std::uint32_t>(node.attribute_integer("vendor_id", drive.vendor_id));
  drive.product_code = static_cast<std::uint32_t>(node.attribute_integer("product_code", drive.product_code));
  drive.serial_number = static_cast<std::uint32_t>(node.attribute_integer("serial_number"));
  drive.sign = static_cast<int>(node.attribute_integer("sign", drive.sign));
  drive.zero_rad = node.attribute_number("zero_rad", 0.0);
  return drive;
}

std::optional<MakerDescription> load_maker(const XmlNode& joint) {
  const auto node = joint.find("koboshi:maker");
  if (!node) return std::nullopt;
  MakerDescription maker;
  maker.servo_id = static_cast<int>(node->attribute_integer("servo_id"));
  maker.sign = static_cast<int>(node->attribute_integer("sign", maker.sign));
  maker.zero_ticks = node->attribute_number("zero_ticks", maker.zero_ticks);
  maker.ticks_per_turn = node->attribute_number("ticks_per_turn", maker.ticks_per_turn);
  return maker;
}

std::vector<std::string> names_of(const ServoTypes& types) {
  std::vector<std::string> names;
  for (const auto& [name, type] : types) names.push_back(name);
  return names;
}

std::string text_or_empty(const XmlNode& joint, const std::string& key) {
  const auto node = joint.find(key);
  return node ? node->text() : std::string();
}

EncoderDescription load_encoder(const XmlNode& node) {
  return {.bits = static_cast<int>(node.attribute_integer("bits")),
          .offset_rad = node.attribute_number("offset_rad", 0.0),
          .noise_counts = node.attribute_number("noise_counts", 0.0)};
}

// Unit vector along the axis of a joint, in the model's frame.
Eigen::Vector3d axis_of(const XmlNode& axis, const std::string& joint, const ModelFrames& frames) {
  const std::vector<double> xyz = axis.child("xyz").numbers();
  const double length = std::sqrt(xyz[0] * xyz[0] + xyz[1] * xyz[1] + xyz[2] * xyz[2]);
  const Eigen::Vector3d unit(xyz[0] / length, xyz[1] / length, xyz[2] / length);
  const auto reference = find_axis_frame(axis);
  return frames.pose(reference ? reference->frame : joint, kModelFrame).rotation.rotate(unit).normalized();
}

}  // namespace

JointDescription load_joint(const XmlNode& node, const ModelFrames& frames, const RobotDescription& robot,
                            const ServoTypes& servo_types) {
  JointDescription description;
  description.name = node.attribute("name");
  description.line = node.line();
  description.parent = found_link(robot, node.child("parent"), frames);
  description.child = found_link(robot, node.child("child"), frames);
  description.p_MJ = frames.pose(description.name, kModelFrame).position;
  const XmlNode axis = node.child("axis");
  description.axis_M = axis_of(axis, description.name, frames);
  description.lower_rad = axis.child("limit").number("lower");
  description.upper_rad = axis.child("limit").number("upper");
  description.max_speed_rad_per_s = axis.child("limit").number("velocity");

  description.stated_role = text_or_empty(node, "koboshi:role");
  description.stated_mirror = text_or_empty(node, "koboshi:mirror");
  description.maker = load_maker(node);
  if (is_follower(node)) return description;
  const XmlNode servo = node.child("koboshi:servo");
  const auto type = servo_types.find(servo.attribute("type"));
  if (type == servo_types.end())
    throw servo.error("type = " + one_line(servo.attribute("type")),
                      expected_servo_type(servo.attribute("type"), names_of(servo_types)));
  description.gear = servo.attribute_number("gear", 1.0);
  description.servo = behind_gear(type->second, description.gear);
  description.encoder = load_encoder(node.child("koboshi:encoder"));
  description.drive = load_drive(node.child("koboshi:drive"));
  return description;
}

bool is_follower(const XmlNode& joint) { return joint.child("axis").find("mimic").has_value(); }

FollowerDescription load_follower(const XmlNode& node, const JointDescription& hinge,
                                  const RobotDescription& robot) {
  const XmlNode mimic = node.child("axis").child("mimic");
  const auto value = [&](const char* key) {
    const auto child = mimic.find(key);
    return child ? child->numbers().front() : 0.0;
  };
  FollowerDescription follower{.hinge = hinge,
                               .leader = robot.find_joint(mimic.attribute("joint")).value(),
                               .multiplier = mimic.number("multiplier")};
  follower.offset_rad = value("offset") - follower.multiplier * value("reference");
  const JointDescription& leader = robot.joints[static_cast<std::size_t>(follower.leader)];
  follower.hinge.lower_rad =
      std::min(follower.position_rad(leader.lower_rad), follower.position_rad(leader.upper_rad));
  follower.hinge.upper_rad =
      std::max(follower.position_rad(leader.lower_rad), follower.position_rad(leader.upper_rad));
  follower.hinge.max_speed_rad_per_s = std::abs(follower.multiplier) * leader.max_speed_rad_per_s;
  return follower;
}

}  // namespace koboshi::sim_board
