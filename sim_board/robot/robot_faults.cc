#include "sim_board/robot/robot_faults.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include "sim_board/input/text.h"
#include "sim_board/input/xml_reader.h"
#include "sim_board/robot/fault_list.h"
#include "sim_board/robot/sdf_schema.h"

namespace koboshi::sim {
namespace {

using Names = std::set<std::string>;

// Names, also of nodes that have not passed the schema.
void take_names(const std::vector<XmlNode>& nodes, Names& names, FaultList& faults) {
  for (const XmlNode& node : nodes) {
    const auto name = node.find_attribute("name");
    if (name && name->find("::") != std::string::npos)
      faults.add(RobotFaultKind::kName, node, "name = " + one_line(*name),
                 "a name without ::, which separates names in SDF", "name");
    if (name && !names.insert(*name).second)
      faults.add(RobotFaultKind::kName, node, "a second " + one_line(*name), "each name once", "name");
  }
}

void find_part_name_faults(const XmlNode& node, FaultList& faults) {
  for (const char* part : {"collision", "visual", "sensor"}) {
    Names names;
    take_names(node.children(part), names, faults);
  }
}

class ReferenceCheck {
 public:
  ReferenceCheck(const XmlNode& model, FaultList& faults) : faults_(faults) {
    take_names(model.children("link"), links_, faults);
    frames_ = links_;  // links and joints share one name space in SDF
    take_names(model.children("joint"), frames_, faults);
  }

  void check_link(const XmlNode& link) {
    find_part_name_faults(link, faults_);
    check_pose(link);
    for (const char* part : {"collision", "visual", "sensor"})
      for (const XmlNode& node : link.children(part)) check_pose(node);
  }

  void check_joint(const XmlNode& joint) {
    find_part_name_faults(joint, faults_);
    check_pose(joint);
    for (const char* end : {"parent", "child"}) {
      const XmlNode node = joint.child(end);
      if (!links_.contains(node.text()))
        faults_.add(RobotFaultKind::kReference, node, "<" + node.name() + "> = " + one_line(node.text()),
                    "the name of a link");
    }
    check_frame(joint.child("axis").child("xyz"), "expressed_in");
  }

 private:
  void check_frame(const XmlNode& node, const std::string& attribute) {
    const auto frame = node.find_attribute(attribute);
    if (frame && *frame != "__model__" && !frames_.contains(*frame))
      faults_.add(RobotFaultKind::kReference, node, attribute + " = " + one_line(*frame),
                  "the name of a link or joint", attribute);
  }

  void check_pose(const XmlNode& node) {
    if (const auto pose = node.find("pose")) check_frame(*pose, "relative_to");
  }

  Names links_;
  Names frames_;
  FaultList& faults_;
};

// Adds the names of a library. Throws InputError for the first fault in it.
void take_library(const std::filesystem::path& file, Names& types) {
  const XmlFile library(file, servo_library_rule());
  for (const XmlNode& type : library.root().children("koboshi:servo_type")) {
    FaultList faults;
    find_servo_faults(type, faults);
    if (!faults.faults().empty()) throw faults.faults().front().error();
    const std::string name = type.attribute("name");
    if (!types.insert(name).second) throw type.error("a second servo type " + name, "each name once");
  }
}

// Checks the servo types and the joints' references to them.
void find_servo_type_faults(const XmlNode& model, const std::filesystem::path& folder, FaultList& faults) {
  Names types;
  for (const XmlNode& type : model.children("koboshi:servo_type")) {
    const auto name = type.find_attribute("name");
    if (name && !types.insert(*name).second)
      faults.add(RobotFaultKind::kName, type, "a second servo type " + one_line(*name), "each name once",
                 "name");
    if (faults.is_sound(type)) find_servo_faults(type, faults);
  }
  bool is_complete = true;
  for (const XmlNode& node : faults.sound_children(model, "koboshi:servo_types")) {
    const std::filesystem::path file = folder / node.attribute("file");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      faults.add(RobotFaultKind::kReference, node, "file = " + one_line(node.attribute("file")),
                 "a library of servo types that exists, relative to this file's folder", "file");
      is_complete = false;
      continue;
    }
    try {
      take_library(file, types);
    } catch (const InputError& error) {
      faults.add(RobotFaultKind::kServoType, node,
                 "file = " + one_line(node.attribute("file")) +
                     (error.line() > 0 ? ", in line " + std::to_string(error.line()) + " " : ", ") +
                     error.found(),
                 error.expected(), "file");
      is_complete = false;
    }
  }
  if (!is_complete) return;
  for (const XmlNode& joint : faults.sound_children(model, "joint")) {
    const XmlNode servo = joint.child("koboshi:servo");
    if (!types.contains(servo.attribute("type")))
      faults.add(RobotFaultKind::kReference, servo, "type = " + one_line(servo.attribute("type")),
                 "the name of a koboshi:servo_type", "type");
  }
}

void find_node_id_faults(const XmlNode& model, FaultList& faults) {
  std::set<std::int64_t> node_ids;
  for (const XmlNode& joint : faults.sound_children(model, "joint")) {
    const XmlNode drive = joint.child("koboshi:drive");
    const std::int64_t node_id = drive.attribute_integer("node_id");
    if (!node_ids.insert(node_id).second)
      faults.add(RobotFaultKind::kNodeId, drive, "a second node_id " + std::to_string(node_id),
                 "each node id once", "node_id");
  }
}

// The tree of links follows from names and references.
bool has_sound_names(const FaultList& faults) {
  return std::ranges::none_of(faults.faults(), [](const RobotFault& fault) {
    return fault.kind == RobotFaultKind::kName || fault.kind == RobotFaultKind::kReference;
  });
}

}  // namespace

std::vector<RobotFault> find_robot_faults(const XmlNode& model, const std::filesystem::path& folder,
                                          const std::vector<XmlNode>& broken) {
  FaultList faults(broken);
  Names model_names;
  take_names({model}, model_names, faults);
  find_unit_faults(model, faults);  // first: other faults may follow from the wrong unit
  ReferenceCheck references(model, faults);
  for (const XmlNode& link : faults.sound_children(model, "link")) {
    references.check_link(link);
    find_link_faults(link, folder, faults);
  }
  for (const XmlNode& joint : faults.sound_children(model, "joint")) {
    references.check_joint(joint);
    find_joint_faults(joint, faults);
  }
  const bool is_tree_known = faults.is_whole() && has_sound_names(faults);
  find_servo_type_faults(model, folder, faults);
  find_node_id_faults(model, faults);
  if (is_tree_known) {
    find_tree_faults(model, faults);
    find_sensor_set_faults(model, faults);
  }
  return faults.faults();
}

}  // namespace koboshi::sim
