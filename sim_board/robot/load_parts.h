#pragma once

#include <sdf/Joint.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <string>

#include "sim_board/input/xml_reader.h"
#include "sim_board/robot/description.h"
#include "sim_board/robot/servo_types.h"

namespace koboshi::sim {

// Steps of load_robot(). libsdformat resolves frames and poses. The XML nodes provide the values that
// libsdformat does not expose (ERP, CFM, the koboshi: elements) and the line of every error.

InputError unknown_to_libsdformat(const XmlNode& node);
// Returns the part that libsdformat has found by the name of `node`. Throws InputError if it has found none:
// the two readers may understand a name differently.
template <typename Part>
const Part& found_part(const Part* part, const XmlNode& node) {
  if (part == nullptr) throw unknown_to_libsdformat(node);
  return *part;
}

// Returns the index of the link with this name. Throws InputError at `node`.
int found_link(const RobotDescription& robot, const XmlNode& node, const std::string& name);

Eigen::Isometry3d to_isometry(const ignition::math::Pose3d& pose);
// Throws InputError at `node` if the pose refers to a missing frame.
Eigen::Isometry3d resolve_pose(const sdf::SemanticPose& pose, const std::string& frame, const XmlNode& node);

LinkDescription load_link(const sdf::Link& link, const XmlNode& node, const std::filesystem::path& folder);

// `folder` is the folder of the robot's file.
ServoTypes load_servo_types(const XmlNode& model_node, const std::filesystem::path& folder);
// Requires that the robot's links are already loaded.
JointDescription load_joint(const sdf::Joint& joint, const XmlNode& node, const RobotDescription& robot,
                            const ServoTypes& servo_types);

// Each function adds the sensors of a link or a joint to the robot.
void load_imus(const sdf::Link& link, const XmlNode& node, RobotDescription& robot);
void load_ankle_sensors(const sdf::Joint& joint, const XmlNode& node, RobotDescription& robot);

}  // namespace koboshi::sim
