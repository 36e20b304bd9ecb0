#include "sim_board/description/robot_keys.h"

#include <map>

#include "sim_board/description/schema/sdf_schema.h"

namespace koboshi::sim_board {
namespace {

void add_keys(const XmlRule& rule, const std::string& path, std::vector<RobotKey>& keys) {
  for (const XmlAttributeRule& attribute : rule.attributes)
    keys.push_back({.path = path + "@" + attribute.name,
                    .name = attribute.name,
                    .is_attribute = true,
                    .count = attribute.required ? XmlCount::kRequired : XmlCount::kOptional,
                    .content = attribute.content,
                    .range = attribute.range,
                    .choices = attribute.choices,
                    .note = attribute.note});
  for (const XmlRule& child : rule.children) {
    const std::string child_path = path.empty() ? child.name : path + "/" + child.name;
    keys.push_back({.path = child_path,
                    .name = child.name,
                    .count = child.count,
                    .content = child.content,
                    .numbers = child.numbers,
                    .range = child.range,
                    .choices = child.choices,
                    .note = child.note});
    add_keys(child, child_path, keys);
  }
}

}  // namespace

std::span<const RobotKey> robot_keys() {
  static const std::vector<RobotKey> keys = [] {
    std::vector<RobotKey> all;
    add_keys(sdf_rule().children.front(), "", all);
    return all;
  }();
  return keys;
}

const RobotKey* find_robot_key(std::string_view path) {
  static const std::map<std::string_view, const RobotKey*> by_path = [] {
    std::map<std::string_view, const RobotKey*> all;
    for (const RobotKey& key : robot_keys()) all.emplace(key.path, &key);
    return all;
  }();
  const auto found = by_path.find(path);
  return found == by_path.end() ? nullptr : found->second;
}

std::string describe_values(const RobotKey& key) {
  return describe_values(key.content, key.numbers, key.range, key.choices);
}

}  // namespace koboshi::sim_board
