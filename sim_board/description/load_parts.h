#pragma once

#include <string>

#include "base/xml/xml_reader.h"
#include "sim_board/description/description.h"
#include "sim_board/description/model_frames.h"
#include "sim_board/description/servo_types.h"

namespace koboshi::sim_board {

// Steps of load_robot(), for a model without faults (find_robot_faults()).

// Returns the index of the link to which the frame that `node` names is attached.
int found_link(const RobotDescription& robot, const XmlNode& node, const ModelFrames& frames);

// Returns the matrix in an <inertia> element, kg m^2.
Eigen::Matrix3d inertia_matrix(const XmlNode& node);
LinkDescription load_link(const XmlNode& node, const ModelFrames& frames,
                          const std::filesystem::path& folder);

// `folder` is the folder of the robot's file.
ServoTypes load_servo_types(const XmlNode& model_node, const std::filesystem::path& folder,
                            ServoLibraries& libraries);
// Requires that the robot's links are already loaded.
JointDescription load_joint(const XmlNode& node, const ModelFrames& frames, const RobotDescription& robot,
                            const ServoTypes& servo_types);

// Whether a joint has <mimic>: it becomes a follower instead of a joint.
bool is_follower(const XmlNode& joint);
// `hinge`: what load_joint() returns for this node. Requires that the robot's joints are already loaded.
FollowerDescription load_follower(const XmlNode& node, const JointDescription& hinge,
                                  const RobotDescription& robot);

// Each function adds the sensors of a link or a joint to the robot.
void load_imus(const XmlNode& link_node, const ModelFrames& frames, RobotDescription& robot);
void load_ankle_sensors(const XmlNode& joint_node, const ModelFrames& frames, RobotDescription& robot);

}  // namespace koboshi::sim_board
