#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/xml/xml_schema.h"

namespace koboshi::sim_board {

// A key of a robot's file: a row of the table in sdf_schema.h.
struct RobotKey {
  // Names of the elements below <model>, then the attribute: "link", "link/inertial/mass",
  // "joint/koboshi:drive@node_id", "@name" for the model's own attribute.
  std::string path;
  std::string name;  // of the element or the attribute: "mass", "node_id"
  bool is_attribute = false;
  XmlCount count = XmlCount::kOptional;  // an attribute is required or optional
  XmlContent content = XmlContent::kChildren;
  std::size_t numbers = 1;  // of a value with content kNumbers
  NumberRange range = {};
  std::vector<std::string> choices = {};
  XmlNote note = {};

  bool has_value() const { return content != XmlContent::kChildren && content != XmlContent::kAnything; }
};

// All keys below <model>, in the order of the table: each element before its attributes and its children.
std::span<const RobotKey> robot_keys();
// Returns the key with this path, or null.
const RobotKey* find_robot_key(std::string_view path);

// Describes the permitted values: "a number from 1e-06 to 1000", "3 times a number from -1 to 1",
// "a whole number from 1 to 127", "imu", "a text"; empty for a key without a value.
std::string describe_values(const RobotKey& key);

}  // namespace koboshi::sim_board
