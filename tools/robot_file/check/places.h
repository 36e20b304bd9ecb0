#pragma once

#include <map>
#include <string>

#include "base/xml/xml_node.h"
#include "tools/robot_file/check/finding.h"

namespace koboshi::tools {

// Where a link, joint, servo type or a part of one is in a robot's file.
struct ModelPlace {
  int line = 0;
  std::string element{};  // as in ModelFinding
  std::string key{};
  std::vector<std::size_t> place{};
};

// The place of a node below <model>.
[[nodiscard]] ModelPlace place_of(const XmlNode& node);
// Sets the place of a finding.
void set_place(ModelFinding& finding, const ModelPlace& place);

// The element of the other side: "right_knee" for "left_knee"; empty for one in the middle.
[[nodiscard]] std::string other_side(const std::string& element);

// The places of a file's named elements, also of one that violates the schema.
class ModelPlaces {
 public:
  explicit ModelPlaces(const XmlNode& sdf);

  // `kind`: "link", "joint" or "koboshi:servo_type"; `part`: a key below it, such as "inertial", or the name
  // of a collision or visual; empty: the element itself. Returns the element's place if it has no such part.
  const ModelPlace& of(const std::string& kind, const std::string& name, const std::string& part = {}) const;

 private:
  void take(const XmlNode& node, const std::string& name);

  std::map<std::string, ModelPlace> places_;
  ModelPlace nowhere_;
};

}  // namespace koboshi::tools
