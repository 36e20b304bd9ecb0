#include <algorithm>

#include "sim_board/description/load_parts.h"

namespace koboshi::sim_board {
namespace {

ChannelDescription load_channel(const XmlNode& sensor, const std::string& name) {
  const XmlNode node = sensor.child(name);
  ChannelDescription channel{.noise_density = node.number("noise_density"),
                             .bias = node.number("bias"),
                             .bias_instability = node.number("bias_instability", 0.0),
                             .random_walk = node.number("random_walk", 0.0),
                             .scale_error = node.number("scale_error", 0.0),
                             .cross_axis = node.number("cross_axis", 0.0),
                             .bandwidth_Hz = node.number("bandwidth_Hz"),
                             .range = node.number("range"),
                             .resolution = node.number("resolution"),
                             .sample_period_s = 1.0 / sensor.number("update_rate"),
                             .jitter_s = sensor.number("koboshi:jitter_s", 0.0),
                             .delay_s = node.number("delay_s")};
  return channel;
}

// Height of the sensor above the lowest corner of the link's boxes, at joint angles zero.
double height_above_sole_m(const LinkDescription& link, const Eigen::Isometry3d& X_LS) {
  double lowest_m = 0.0;
  bool first = true;
  for (const BoxDescription& box : link.collisions) {
    const Eigen::Isometry3d X_MG = link.X_ML * box.X_LG;
    const double reach_m = X_MG.linear().row(2).cwiseAbs().dot(box.size_m.transpose()) / 2;
    const double bottom_m = X_MG.translation().z() - reach_m;
    lowest_m = first ? bottom_m : std::min(lowest_m, bottom_m);
    first = false;
  }
  return (link.X_ML * X_LS).translation().z() - lowest_m;
}

}  // namespace

void load_imus(const XmlNode& link_node, const ModelFrames& frames, RobotDescription& robot) {
  const std::string link = link_node.attribute("name");
  for (const XmlNode& node : link_node.children("sensor")) {
    robot.imu = ImuDescription{.name = node.attribute("name"),
                               .line = node.line(),
                               .link = robot.find_link(link).value(),
                               .X_LS = frames.part_pose(node, link).isometry(),
                               .gyro = load_channel(node, "koboshi:gyro"),
                               .accelerometer = load_channel(node, "koboshi:accelerometer"),
                               .g_sensitivity = node.child("koboshi:gyro").number("g_sensitivity", 0.0)};
  }
}

void load_ankle_sensors(const XmlNode& joint_node, const ModelFrames& frames, RobotDescription& robot) {
  const std::string joint = joint_node.attribute("name");
  for (const XmlNode& node : joint_node.children("sensor")) {
    const std::string name = node.attribute("name");
    const LinkDescription& foot =
        robot.links[static_cast<std::size_t>(found_link(robot, joint_node.child("child"), frames))];
    const auto pose = node.find("pose");  // in the joint's frame
    const FramePose X_JS = pose ? FramePose::from_numbers(pose->numbers()) : FramePose();
    AnkleSensorDescription sensor{.name = name,
                                  .line = node.line(),
                                  .joint = robot.find_joint(joint).value(),
                                  .X_LS = frames.pose(joint, foot.name).isometry() * X_JS.isometry(),
                                  .force = load_channel(node, "koboshi:force"),
                                  .torque = load_channel(node, "koboshi:torque"),
                                  .crosstalk = node.number("koboshi:crosstalk", 0.0)};
    sensor.height_above_sole_m = height_above_sole_m(foot, sensor.X_LS);
    (name == "left_ankle" ? robot.left_ankle : robot.right_ankle) = sensor;
  }
}

}  // namespace koboshi::sim_board
