#include <sdf/JointAxis.hh>

#include "sim_board/robot/load_parts.h"

namespace koboshi::sim {
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

EncoderDescription load_encoder(const XmlNode& node) {
  return {.bits = static_cast<int>(node.attribute_integer("bits")),
          .offset_rad = node.attribute_number("offset_rad", 0.0),
          .noise_counts = node.attribute_number("noise_counts", 0.0)};
}

}  // namespace

JointDescription load_joint(const sdf::Joint& joint, const XmlNode& node, const RobotDescription& robot,
                            const ServoTypes& servo_types) {
  JointDescription description;
  description.name = joint.Name();
  description.line = node.line();
  description.parent = found_link(robot, node.child("parent"), node.child("parent").text());
  description.child = found_link(robot, node.child("child"), node.child("child").text());
  description.p_MJ = resolve_pose(joint.SemanticPose(), "__model__", node).translation();

  const sdf::JointAxis& axis = found_part(joint.Axis(0), node);
  ignition::math::Vector3d axis_M;
  if (const auto errors = axis.ResolveXyz(axis_M, "__model__"); !errors.empty()) {
    throw node.error(one_line(errors.front().Message()), "an axis in a frame of this model");
  }
  description.axis_M = Eigen::Vector3d(axis_M.X(), axis_M.Y(), axis_M.Z()).normalized();
  description.lower_rad = axis.Lower();
  description.upper_rad = axis.Upper();
  description.max_speed_rad_per_s = axis.MaxVelocity();

  const XmlNode servo = node.child("koboshi:servo");
  const auto type = servo_types.find(servo.attribute("type"));
  if (type == servo_types.end())
    throw servo.error("type = " + one_line(servo.attribute("type")), "the name of a koboshi:servo_type");
  description.servo = type->second;
  description.encoder = load_encoder(node.child("koboshi:encoder"));
  description.drive = load_drive(node.child("koboshi:drive"));
  return description;
}

}  // namespace koboshi::sim
