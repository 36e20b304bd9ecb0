#include "sim_board/robot/load.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <sdf/Console.hh>
#include <sdf/ParserConfig.hh>
#include <sdf/Root.hh>
#include <sdf/SDFImpl.hh>
#include <sdf/parser.hh>
#include <set>
#include <utility>

#include "sim_board/robot/load_parts.h"
#include "sim_board/robot/robot_faults.h"
#include "sim_board/robot/sdf_schema.h"

namespace koboshi::sim {
namespace {

sdf::SDFPtr read_description() {
  auto description = std::make_shared<sdf::SDF>();
  sdf::init(description);
  return description;
}

// SDF's own descriptions of its elements, which a program that loads several robots reads once: a copy takes
// a third of the time. A first robot needs no copy.
sdf::SDFPtr empty_description() {
  static std::mutex mutex;
  static sdf::SDFPtr kept;
  static bool is_first = true;
  const std::lock_guard lock(mutex);
  // libsdformat would print each error a second time, in colour; they are returned, too.
  sdf::Console::Instance()->SetQuiet(true);
  if (std::exchange(is_first, false)) return read_description();
  if (!kept) kept = read_description();
  auto copy = std::make_shared<sdf::SDF>();
  copy->Root(kept->Root()->Clone());
  return copy;
}

sdf::Errors load_description(const std::string& text, const sdf::ParserConfig& config, sdf::Root& root) {
  const sdf::SDFPtr description = empty_description();
  sdf::Errors errors;
  sdf::readString(text, config, description, errors);
  if (!errors.empty()) return errors;
  return root.Load(description, config);
}

// Loads the frames of a text that has passed the schema with libsdformat.
void load_sdf(const XmlFile& file, const std::string& text, sdf::Root& root) {
  sdf::ParserConfig config;
  config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  const sdf::Errors errors = load_description(text, config, root);
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
    const sdf::Link& link = found_part(model.LinkByName(node.attribute("name")), node);
    robot.links.push_back(load_link(link, node, robot.file.parent_path()));
    if (!children.contains(link.Name()))
      std::rotate(robot.links.begin(), robot.links.end() - 1, robot.links.end());
  }
}

void load_joints(const sdf::Model& model, const XmlNode& model_node, RobotDescription& robot) {
  const ServoTypes servo_types = load_servo_types(model_node, robot.file.parent_path());
  for (const XmlNode& node : model_node.children("joint"))
    robot.joints.push_back(
        load_joint(found_part(model.JointByName(node.attribute("name")), node), node, robot, servo_types));
  std::sort(
      robot.joints.begin(), robot.joints.end(),
      [](const JointDescription& a, const JointDescription& b) { return a.drive.node_id < b.drive.node_id; });
}

void load_sensors(const sdf::Model& model, const XmlNode& model_node, RobotDescription& robot) {
  for (const XmlNode& node : model_node.children("link")) {
    load_imus(found_part(model.LinkByName(node.attribute("name")), node), node, robot);
  }
  for (const XmlNode& node : model_node.children("joint")) {
    load_ankle_sensors(found_part(model.JointByName(node.attribute("name")), node), node, robot);
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

InputError unknown_to_libsdformat(const XmlNode& node) {
  return node.error("the name " + one_line(node.attribute("name")), "a name by which libsdformat finds it");
}

int found_link(const RobotDescription& robot, const XmlNode& node, const std::string& name) {
  const auto link = robot.find_link(name);
  if (!link) throw node.error("<" + node.name() + "> = " + one_line(name), "the name of a link");
  return *link;
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
  const std::vector<RobotFault> faults = find_robot_faults(model_node, file.parent_path());
  if (!faults.empty()) throw faults.front().error();
  sdf::Root root;
  load_sdf(xml, text, root);
  if (root.Model() == nullptr) throw model_node.error("no model that libsdformat finds", "one");
  const sdf::Model& model = *root.Model();

  RobotDescription robot;
  robot.name = model.Name();
  robot.file = file;
  robot.line = model_node.line();
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
