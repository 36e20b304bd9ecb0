#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/description/model_frames.h"
#include "sim_board/description/robot_faults.h"

namespace koboshi::sim_board {

// The faults of a model that find_robot_faults() collects.
class FaultList {
 public:
  explicit FaultList(std::vector<XmlNode> broken = {}) : broken_(std::move(broken)) {}

  void add(RobotFaultKind kind, const XmlNode& node, std::string found, std::string expected,
           std::string attribute = {}) {
    faults_.push_back({kind, node, std::move(attribute), std::move(found), std::move(expected)});
  }

  bool is_whole() const { return broken_.empty(); }
  bool is_sound(const XmlNode& node) const {
    return std::find(broken_.begin(), broken_.end(), node) == broken_.end();
  }
  // The children with this name that have passed the schema.
  std::vector<XmlNode> sound_children(const XmlNode& parent, const std::string& name) const {
    std::vector<XmlNode> nodes = parent.children(name);
    std::erase_if(nodes, [this](const XmlNode& node) { return !is_sound(node); });
    return nodes;
  }

  bool has_fault(const XmlNode& node) const {
    return std::any_of(faults_.begin(), faults_.end(),
                       [&node](const RobotFault& fault) { return fault.node == node; });
  }
  const std::vector<RobotFault>& faults() const { return faults_; }

 private:
  std::vector<XmlNode> broken_;
  std::vector<RobotFault> faults_;
};

// Parts of find_robot_faults(): of one link, joint, servo type, sensor.
void find_link_faults(const XmlNode& link, const std::filesystem::path& folder, FaultList& faults);
void find_joint_faults(const XmlNode& joint, FaultList& faults);
void find_servo_faults(const XmlNode& servo_type, FaultList& faults);
void find_sensor_faults(const XmlNode& sensor, FaultList& faults);
void find_ankle_faults(const XmlNode& sensor, FaultList& faults);  // of a joint's sensor
void find_unit_faults(const XmlNode& model, FaultList& faults);
void find_coupling_faults(const XmlNode& model, FaultList& faults);  // of the joints with <mimic>
// Find the faults of the model as a whole; all references must be sound.
void find_tree_faults(const XmlNode& model, const ModelFrames& frames, FaultList& faults);
void find_role_faults(const XmlNode& model, FaultList& faults);
void find_sensor_set_faults(const XmlNode& model, const ModelFrames& frames, FaultList& faults);

}  // namespace koboshi::sim_board
