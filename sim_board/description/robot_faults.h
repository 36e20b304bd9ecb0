#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/xml/xml_node.h"

namespace koboshi::sim_board {

class ServoLibraries;

// The faults that a robot's file may have although its schema permits them: no simulation could run it.
enum class RobotFaultKind {
  kName,       // a name that is used twice, or that SDF refuses
  kVersion,    // a key of another version of SDF
  kReference,  // to a link, joint, frame, servo type or library that is not there
  kInertia,    // of no rigid body
  kAxis,       // not a unit vector
  kLimits,     // lower not below upper
  kShaft,      // beyond the turn of its encoder
  kNodeId,     // used twice
  kFrameRing,  // frames that refer to each other in a ring
  kTree,       // joints that form no tree of all links
  kRole,       // a role or a maker's servo of two joints, mirrors that are not mutual
  kMesh,       // a file that is missing
  kShape,      // a visual with none or several, a direction of friction that is zero
  kServoType,  // values that contradict each other
  kSensor,     // values that contradict each other, a second sensor, an ankle without a sole
  kCoupling,   // a joint with <mimic> that has a drive, or follows a joint that cannot lead it
  kUnit        // a value that no robot of this size has
};

struct RobotFault {
  RobotFaultKind kind;
  XmlNode node;           // whose line the message gives
  std::string attribute;  // of the node, where the fault is in one
  std::string found;      // as in InputError
  std::string expected;   // as in InputError

  InputError error() const { return node.error(found, expected); }
};

// Finds all faults of a model that has passed its schema. `broken` lists the children of <model> that have
// not; they are left out, and with them what concerns the model as a whole: tree, references, the sensors'
// number. Paths are relative to `folder`.
std::vector<RobotFault> find_robot_faults(const XmlNode& model, const std::filesystem::path& folder,
                                          const std::vector<XmlNode>& broken = {});
// The same, with libraries that the caller goes on to read.
std::vector<RobotFault> find_robot_faults(const XmlNode& model, const std::filesystem::path& folder,
                                          const std::vector<XmlNode>& broken, ServoLibraries& libraries);

}  // namespace koboshi::sim_board
