#include "sim_board/description/load.h"

#include <algorithm>
#include <set>

#include "sim_board/description/load_parts.h"
#include "sim_board/description/robot_faults.h"
#include "sim_board/description/schema/sdf_schema.h"

namespace koboshi::sim_board {
namespace {

// Loads the links, with the base (the only link that is not a joint's child) first.
void load_links(const XmlNode& model, const ModelFrames& frames, RobotDescription& robot) {
  std::set<std::string> children;
  for (const XmlNode& joint : model.children("joint"))
    children.insert(frames.link_of(joint.child("child").text()));
  for (const XmlNode& node : model.children("link")) {
    robot.links.push_back(load_link(node, frames, robot.file.parent_path()));
    if (!children.contains(robot.links.back().name))
      std::rotate(robot.links.begin(), robot.links.end() - 1, robot.links.end());
  }
}

void load_joints(const XmlNode& model, const ModelFrames& frames, ServoLibraries& libraries,
                 RobotDescription& robot) {
  const ServoTypes servo_types = load_servo_types(model, robot.file.parent_path(), libraries);
  const std::vector<XmlNode> nodes = model.children("joint");
  for (const XmlNode& node : nodes)
    if (!is_follower(node)) robot.joints.push_back(load_joint(node, frames, robot, servo_types));
  std::sort(
      robot.joints.begin(), robot.joints.end(),
      [](const JointDescription& a, const JointDescription& b) { return a.drive.node_id < b.drive.node_id; });
  for (const XmlNode& node : nodes)
    if (is_follower(node))
      robot.followers.push_back(load_follower(node, load_joint(node, frames, robot, servo_types), robot));
}

XmlFile open_file(const std::filesystem::path& file, const std::string& text) {
  try {
    return XmlFile(file, text, sdf_rule());
  } catch (const InputError& error) {
    throw with_import_advice(error);
  }
}

}  // namespace

int found_link(const RobotDescription& robot, const XmlNode& node, const ModelFrames& frames) {
  return robot.find_link(frames.link_of(node.text())).value();
}

RobotDescription load_robot(const std::filesystem::path& file) {
  return load_robot(file, read_text_file(file, "an XML file"));
}

RobotDescription load_robot(const std::filesystem::path& file, const std::string& text) {
  const XmlFile xml = open_file(file, text);
  const XmlNode model = xml.root().child("model");
  ServoLibraries libraries;
  const std::vector<RobotFault> faults = find_robot_faults(model, file.parent_path(), {}, libraries);
  if (!faults.empty()) throw faults.front().error();
  const ModelFrames frames(model);

  RobotDescription robot;
  robot.name = model.attribute("name");
  robot.file = file;
  robot.line = model.line();
  load_links(model, frames, robot);
  load_joints(model, frames, libraries, robot);
  if (const auto battery = model.find("koboshi:battery")) {
    robot.battery = {.open_circuit_V = battery->attribute_number("open_circuit_V", 0.0),
                     .internal_resistance_ohm = battery->attribute_number("internal_resistance_ohm", 0.0)};
  }
  for (const XmlNode& link : model.children("link")) load_imus(link, frames, robot);
  for (const XmlNode& joint : model.children("joint")) load_ankle_sensors(joint, frames, robot);
  return robot;
}

}  // namespace koboshi::sim_board
