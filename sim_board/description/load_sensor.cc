#include <algorithm>

#include "sim_board/description/load_parts.h"
#include "sim_board/description/schema/schema_rules.h"

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

// A switch follows the load of its foot within milliseconds.
ChannelDescription switch_channel(const XmlNode& sensor) {
  return {.bandwidth_Hz = 200.0,
          .range = 32.0 * sensor.number("koboshi:closing_force_N"),
          .resolution = sensor.number("koboshi:closing_force_N") / 1000.0,
          .sample_period_s = 1.0 / sensor.number("update_rate"),
          .jitter_s = sensor.number("koboshi:jitter_s", 0.0)};
}

// The sensing elements, by the type of the sensor.
void load_elements(const XmlNode& node, AnkleSensorDescription& sensor) {
  const std::string type = node.attribute("type");
  if (type == kPressureCellsType) {
    sensor.kind = hal::AnkleKind::kPressureCells;
    sensor.force = sensor.torque = load_channel(node, "koboshi:cell_force");
    const std::vector<XmlNode> cells = node.children("koboshi:cell");
    for (std::size_t i = 0; i < sensor.cells_S_m.size(); ++i) {
      const std::vector<double> place = cells.at(i).numbers();
      sensor.cells_S_m[i] = {place[0], place[1]};
    }
  } else if (type == kContactSwitchType) {
    sensor.kind = hal::AnkleKind::kContactSwitch;
    sensor.force = sensor.torque = switch_channel(node);
    sensor.closing_force_N = node.number("koboshi:closing_force_N");
  } else {
    sensor.force = load_channel(node, "koboshi:force");
    sensor.torque = load_channel(node, "koboshi:torque");
  }
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
                                  .force = {},
                                  .torque = {},
                                  .crosstalk = node.number("koboshi:crosstalk", 0.0)};
    load_elements(node, sensor);
    sensor.height_above_sole_m = height_above_sole_m(foot, sensor.X_LS);
    (name == "left_ankle" ? robot.left_ankle : robot.right_ankle) = sensor;
  }
}

}  // namespace koboshi::sim_board
