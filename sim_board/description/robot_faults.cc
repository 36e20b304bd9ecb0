#include "sim_board/description/robot_faults.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include "base/text/text.h"
#include "sim_board/description/fault_list.h"
#include "sim_board/description/load_parts.h"
#include "sim_board/description/reserved_nodes.h"
#include "sim_board/description/schema/sdf_version.h"
#include "sim_board/description/servo_types.h"

namespace koboshi::sim_board {
namespace {

using Names = std::set<std::string>;

// Whether SDF keeps a name for itself.
bool is_reserved(const std::string& name) {
  return name == "world" || (name.size() >= 4 && name.starts_with("__") && name.ends_with("__"));
}

// Names, also of nodes that have not passed the schema.
void take_names(const std::vector<XmlNode>& nodes, Names& names, FaultList& faults) {
  for (const XmlNode& node : nodes) {
    const auto name = node.find_attribute("name");
    if (name && name->find("::") != std::string::npos)
      faults.add(RobotFaultKind::kName, node, "name = " + one_line(*name),
                 "a name without ::, which separates names in SDF", "name");
    if (name && is_reserved(*name))
      faults.add(RobotFaultKind::kName, node, "name = " + one_line(*name),
                 "a name other than world and __...__, which SDF reserves", "name");
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
    all_ = links_;  // links, joints and frames share one name space in SDF
    take_names(model.children("joint"), all_, faults);
    joints_ = all_;
    take_names(model.children("frame"), all_, faults);
    has_frames_ = model.find("frame").has_value();
  }

  void check_model(const XmlNode& model) {
    const auto canonical = model.find_attribute("canonical_link");
    if (canonical && !links_.contains(*canonical))
      add(model, "canonical_link", *canonical, "the name of a link");
    if (const auto frame = model.find_attribute("placement_frame"))
      check_frame({model, "placement_frame", *frame});
  }

  void check_frame_element(const XmlNode& frame) {
    check_pose(frame);
    if (const auto base = frame.find_attribute("attached_to")) check_frame({frame, "attached_to", *base});
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
      const std::string name = node.text();
      const bool is_frame = all_.contains(name) && !joints_.contains(name);
      if (!links_.contains(name) && !is_frame)
        faults_.add(RobotFaultKind::kReference, node, "<" + node.name() + "> = " + one_line(name),
                    has_frames_ ? "the name of a link or frame" : "the name of a link");
    }
    const XmlNode axis = joint.child("axis");
    check_version(axis);
    if (const auto frame = find_axis_frame(axis)) check_frame(*frame);
  }

 private:
  void add(const XmlNode& node, const std::string& attribute, const std::string& name,
           const std::string& expected) {
    faults_.add(RobotFaultKind::kReference, node, attribute + " = " + one_line(name), expected, attribute);
  }

  void check_frame(const FrameReference& reference) {
    if (reference.frame != kModelFrame && !all_.contains(reference.frame))
      add(reference.node, reference.attribute, reference.frame,
          has_frames_ ? "the name of a link, joint or frame" : "the name of a link or joint");
  }

  void check_pose(const XmlNode& node) {
    const auto pose = node.find("pose");
    if (!pose) return;
    check_version(*pose);
    if (const auto frame = find_pose_frame(*pose)) check_frame(*frame);
  }

  void check_version(const XmlNode& owner) {
    for (OlderKeyFault& fault : find_older_key_faults(owner))
      faults_.add(RobotFaultKind::kVersion, fault.node, std::move(fault.found), std::move(fault.expected),
                  std::move(fault.attribute));
  }

  Names links_;
  Names joints_;  // and links
  Names all_;     // and frames
  bool has_frames_ = false;
  FaultList& faults_;
};

// Adds the names of a library. Throws InputError for the first fault in it.
void take_library(const XmlFile& library, Names& types) {
  for (const XmlNode& type : library.root().children("koboshi:servo_type")) {
    FaultList faults;
    find_servo_faults(type, faults);
    if (!faults.faults().empty()) throw faults.faults().front().error();
    const std::string name = type.attribute("name");
    if (!types.insert(name).second) throw type.error("a second servo type " + name, "each name once");
  }
}

// Checks the servo types and the joints' references to them.
void find_servo_type_faults(const XmlNode& model, const std::filesystem::path& folder,
                            ServoLibraries& libraries, FaultList& faults) {
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
      take_library(libraries.open(file), types);
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
    if (is_follower(joint)) continue;
    const XmlNode servo = joint.child("koboshi:servo");
    if (!types.contains(servo.attribute("type")))
      faults.add(
          RobotFaultKind::kReference, servo, "type = " + one_line(servo.attribute("type")),
          expected_servo_type(servo.attribute("type"), std::vector<std::string>(types.begin(), types.end())),
          "type");
  }
}

void find_node_id_faults(const XmlNode& model, FaultList& faults) {
  std::set<std::int64_t> node_ids;
  for (const XmlNode& joint : faults.sound_children(model, "joint")) {
    if (is_follower(joint)) continue;
    const XmlNode drive = joint.child("koboshi:drive");
    const std::int64_t node_id = drive.attribute_integer("node_id");
    if (!node_ids.insert(node_id).second)
      faults.add(RobotFaultKind::kNodeId, drive, "a second node_id " + std::to_string(node_id),
                 "each node id once", "node_id");
    if (const std::string_view owner = owner_of_node(node_id); !owner.empty())
      faults.add(RobotFaultKind::kNodeId, drive,
                 "node_id = " + std::to_string(node_id) + ", that of " + std::string(owner),
                 "another from 3 to 127", "node_id");
  }
}

// Frames and the tree of links follow from names and references.
bool has_sound_names(const FaultList& faults) {
  return std::ranges::none_of(faults.faults(), [](const RobotFault& fault) {
    return fault.kind == RobotFaultKind::kName || fault.kind == RobotFaultKind::kReference;
  });
}

void find_ring_faults(const ModelFrames& frames, FaultList& faults) {
  for (const FrameRing& ring : frames.rings()) {
    std::string names;
    for (const std::string& name : ring.names) names += (names.empty() ? "" : ", ") + one_line(name);
    const auto reference =
        ring.is_of_poses && ring.node.name() == "pose" ? find_pose_frame(ring.node) : std::nullopt;
    faults.add(RobotFaultKind::kFrameRing, ring.node,
               (ring.is_of_poses ? "a ring of poses: " : "a ring of attached frames: ") + names,
               ring.is_of_poses ? "poses that lead to the model's frame" : "frames that lead to a link",
               reference ? reference->attribute : "");
  }
}

}  // namespace

std::vector<RobotFault> find_robot_faults(const XmlNode& model, const std::filesystem::path& folder,
                                          const std::vector<XmlNode>& broken) {
  ServoLibraries libraries;
  return find_robot_faults(model, folder, broken, libraries);
}

std::vector<RobotFault> find_robot_faults(const XmlNode& model, const std::filesystem::path& folder,
                                          const std::vector<XmlNode>& broken, ServoLibraries& libraries) {
  FaultList faults(broken);
  Names model_names;
  take_names({model}, model_names, faults);
  find_unit_faults(model, faults);  // first: other faults may follow from the wrong unit
  ReferenceCheck references(model, faults);
  references.check_model(model);
  for (const XmlNode& link : faults.sound_children(model, "link")) {
    references.check_link(link);
    find_link_faults(link, folder, faults);
  }
  for (const XmlNode& joint : faults.sound_children(model, "joint")) {
    references.check_joint(joint);
    find_joint_faults(joint, faults);
  }
  find_coupling_faults(model, faults);
  for (const XmlNode& frame : faults.sound_children(model, "frame")) references.check_frame_element(frame);
  const bool is_tree_known = faults.is_whole() && has_sound_names(faults);
  find_servo_type_faults(model, folder, libraries, faults);
  find_node_id_faults(model, faults);
  if (is_tree_known) {
    const ModelFrames frames(model);
    find_ring_faults(frames, faults);
    const bool has_ring = std::ranges::any_of(
        faults.faults(), [](const RobotFault& fault) { return fault.kind == RobotFaultKind::kFrameRing; });
    if (has_ring) return faults.faults();
    find_tree_faults(model, frames, faults);
    find_sensor_set_faults(model, frames, faults);
    find_role_faults(model, faults);
  }
  return faults.faults();
}

}  // namespace koboshi::sim_board
