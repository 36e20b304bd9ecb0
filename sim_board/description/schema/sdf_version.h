#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/xml/xml_node.h"

namespace koboshi::sim_board {

// Robot files may be of the versions 1.5 to 1.9 of SDF, which differ in few of the keys that a robot may use.
// The reader understands the older keys where they stand instead of rewriting the file: messages and editors
// show the file's own keys and lines.

// An older key in a file of a version that no longer has it, or beside its successor.
struct OlderKeyFault {
  XmlNode node;           // the older element, or the owner of the older attribute
  std::string attribute;  // empty: the node itself is the older key
  std::string found;      // as in InputError
  std::string expected;   // as in InputError
};

// Finds the faulty older keys of an element of a model; those of its children are not included.
std::vector<OlderKeyFault> find_older_key_faults(const XmlNode& owner);

// Name of the model's own frame.
inline constexpr const char* kModelFrame = "__model__";

// A reference to a frame, as the file states it.
struct FrameReference {
  XmlNode node;
  std::string attribute;  // of the node; empty: the node implies the frame
  std::string frame;      // name of a link, joint or frame, or kModelFrame
};

// Returns the frame of a <pose>, or nothing if it is the default.
std::optional<FrameReference> find_pose_frame(const XmlNode& pose);
// Returns the frame in which the vector of an <axis> is given, or nothing if it is the joint's.
std::optional<FrameReference> find_axis_frame(const XmlNode& axis);

}  // namespace koboshi::sim_board
