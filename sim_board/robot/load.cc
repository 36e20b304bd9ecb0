#include "sim_board/robot/load.h"

#include <algorithm>
#include <sdf/ParserConfig.hh>
#include <sdf/Root.hh>
#include <set>

#include "sim_board/robot/check_model.h"
#include "sim_board/robot/load_parts.h"
#include "sim_board/robot/sdf_schema.h"

namespace koboshi::sim {
namespace {

// Loads the frames of a text that has passed the schema with libsdformat.
void load_sdf(const XmlFile& file, const std::string& text, sdf::Root& root) {
  sdf::ParserConfig config;
  config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  const sdf::Errors errors = root.LoadSdfString(text, config);
  if (errors.empty()) return;
  const sdf::Error& first = errors.front();
  throw InputError(file.path(), first.LineNumber().value_or(file.root().child("model").line()),
                   one_line(first.Message()), "a model that libsdformat accepts");
}

// Loads the links, with the base (the only link that is not a joint's child) first.
void load_links(const sdf::Model& model, const XmlNode& model_node, RobotDescription& robot) {
  std::set<std::string> children;
  for (const XmlNode& joint : model_node.children("joint")) children.insert(joint.child("child").text());
  for (const XmlNode& node : model_node.children("link")) {
    const sdf::Link& link = *model.LinkByName(node.attribute("name"));
    robot.links.push_back(load_link(link, node, robot.file.parent_path()));
    if (children.contains(link.Name())) continue;
    if (!children.contains(robot.links.front().name) && robot.links.size() > 1) {
      throw node.error("link " + link.Name() + ", no joint's child",
                       "only " + robot.links.front().name + " to be that");
    }
    std::rotate(robot.links.begin(), robot.links.end() - 1, robot.links.end());
  }
  if (robot.links.empty()) throw model_node.error("a model without links", "one link or more");
  if (children.contains(robot.links.front().name)) {
    throw model_node.error("no link that is no joint's child", "a base from which the joints make a tree");
  }
}

// With one base and no link twice a child, links that the base does not reach form a loop.
void check_tree(const RobotDescription& robot, const XmlNode& model_node) {
  std::vector<bool> reached(robot.links.size(), false);
  reached[0] = true;
  for (bool grows = true; grows;) {
    grows = false;
    for (const JointDescription& joint : robot.joints) {
      const auto parent = static_cast<std::size_t>(joint.parent);
      const auto child = static_cast<std::size_t>(joint.child);
      if (!reached[parent] || reached[child]) continue;
      reached[child] = true;
      grows = true;
    }
  }
  for (const XmlNode& node : model_node.children("link")) {
    if (!reached[static_cast<std::size_t>(robot.find_link(node.attribute("name")).value())]) {
      throw node.error("link " + node.attribute("name") + " in a ring of joints",
                       "a tree from " + robot.links[0].name);
    }
  }
}

void load_joints(const sdf::Model& model, const XmlNode& model_node, RobotDescription& robot) {
  const ServoTypes servo_types = load_servo_types(model_node, robot.file.parent_path());
  std::set<int> children;
  std::set<int> node_ids;
  for (const XmlNode& node : model_node.children("joint")) {
    const sdf::Joint& joint = *model.JointByName(node.attribute("name"));
    const JointDescription description = load_joint(joint, node, robot, servo_types);
    if (!children.insert(description.child).second) {
      throw node.error("a second joint that moves link " + node.child("child").text(), "one joint a link");
    }
    if (!node_ids.insert(description.drive.node_id).second) {
      throw node.child("koboshi:drive")
          .error("a second node_id " + std::to_string(description.drive.node_id), "each node id once");
    }
    robot.joints.push_back(description);
  }
  std::sort(
      robot.joints.begin(), robot.joints.end(),
      [](const JointDescription& a, const JointDescription& b) { return a.drive.node_id < b.drive.node_id; });
  check_tree(robot, model_node);
}

void load_sensors(const sdf::Model& model, const XmlNode& model_node, RobotDescription& robot) {
  for (const XmlNode& node : model_node.children("link")) {
    load_imus(*model.LinkByName(node.attribute("name")), node, robot);
  }
  for (const XmlNode& node : model_node.children("joint")) {
    load_ankle_sensors(*model.JointByName(node.attribute("name")), node, robot);
  }
}

}  // namespace

Eigen::Isometry3d to_isometry(const ignition::math::Pose3d& pose) {
  const auto& q = pose.Rot();
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized().toRotationMatrix();
  isometry.translation() = Eigen::Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
  return isometry;
}

Eigen::Isometry3d resolve_pose(const sdf::SemanticPose& pose, const std::string& frame, const XmlNode& node) {
  ignition::math::Pose3d resolved;
  if (const auto errors = pose.Resolve(resolved, frame); !errors.empty()) {
    throw node.error(one_line(errors.front().Message()), "a pose relative to a link or joint of this model");
  }
  return to_isometry(resolved);
}

RobotDescription load_robot(const std::filesystem::path& file) {
  return load_robot(file, read_text_file(file, "an XML file"));
}

RobotDescription load_robot(const std::filesystem::path& file, const std::string& text) {
  const XmlFile xml(file, text, sdf_rule());
  const XmlNode model_node = xml.root().child("model");
  check_model(model_node);
  sdf::Root root;
  load_sdf(xml, text, root);
  const sdf::Model& model = *root.Model();

  RobotDescription robot;
  robot.name = model.Name();
  robot.file = file;
  load_links(model, model_node, robot);
  load_joints(model, model_node, robot);
  if (const auto battery = model_node.find("koboshi:battery")) {
    robot.battery = {.open_circuit_V = battery->attribute_number("open_circuit_V", 0.0),
                     .internal_resistance_ohm = battery->attribute_number("internal_resistance_ohm", 0.0)};
  }
  load_sensors(model, model_node, robot);
  return robot;
}

}  // namespace koboshi::sim
