#pragma once

#include <sdf/Joint.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <string>

#include "sim_board/input/xml_reader.h"
#include "sim_board/robot/description.h"
#include "sim_board/robot/servo_types.h"

namespace koboshi::sim {

// The steps of load_robot(). libsdformat resolves frames and poses; the XML node of the same thing gives the
// numbers that libsdformat keeps to itself (ERP, CFM, the koboshi: elements) and the line of every error.

Eigen::Isometry3d to_isometry(const ignition::math::Pose3d& pose);
// Throws InputError at `node` if the pose hangs on a frame that does not exist.
Eigen::Isometry3d resolve_pose(const sdf::SemanticPose& pose, const std::string& frame, const XmlNode& node);

LinkDescription load_link(const sdf::Link& link, const XmlNode& node, const std::filesystem::path& folder);

// `folder` is where the robot's file lies.
ServoTypes load_servo_types(const XmlNode& model_node, const std::filesystem::path& folder);
// The robot's links must be there already.
JointDescription load_joint(const sdf::Joint& joint, const XmlNode& node, const RobotDescription& robot,
                            const ServoTypes& servo_types);

// Each adds the sensors of a link or a joint to the robot.
void load_imus(const sdf::Link& link, const XmlNode& node, RobotDescription& robot);
void load_ankle_sensors(const sdf::Joint& joint, const XmlNode& node, RobotDescription& robot);

}  // namespace koboshi::sim
