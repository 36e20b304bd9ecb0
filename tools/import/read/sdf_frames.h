#pragma once

#include <Eigen/Geometry>
#include <map>
#include <set>
#include <string>

#include "base/xml/xml_node.h"

namespace koboshi::tools {

// The frames of an SDF model: those of links, joints and <frame> elements, each with a pose in another. The
// reader's own robot files are resolved by sim_board's ModelFrames, which asks for our schema.
class SdfFrames {
 public:
  // Throws InputError for a name that is used twice.
  explicit SdfFrames(const XmlNode& model);

  // Returns the pose of a frame in the model at joint angles zero. `node` is the element that names it.
  // Throws InputError for frames that are missing or refer to each other in a ring.
  Eigen::Isometry3d pose_in_model(const std::string& name, const XmlNode& node);
  // Returns the pose of an element in the model; without relative_to, its <pose> is in the frame `parent`.
  Eigen::Isometry3d pose_in_model(const XmlNode& element, const std::string& parent);
  // Returns the link with which a frame moves.
  std::string link_of(const std::string& name, const XmlNode& node) const;

 private:
  struct Frame {
    XmlNode node;
    std::string parent{};  // in whose frame the pose is without relative_to; empty: the model
  };

  std::map<std::string, Frame> frames_;
  std::map<std::string, Eigen::Isometry3d> poses_;  // those that are known
  std::set<std::string> open_;                      // those that are being resolved
};

// Returns the frame that a <pose> names; empty if it names none.
[[nodiscard]] std::string relative_to(const XmlNode& pose);
// Returns the numbers of the <pose> of an element; the identity without one.
[[nodiscard]] Eigen::Isometry3d pose_of_element(const XmlNode& element);

}  // namespace koboshi::tools
