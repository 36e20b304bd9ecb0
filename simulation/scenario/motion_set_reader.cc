#include "simulation/scenario/motion_set_reader.h"

#include <algorithm>
#include <optional>
#include <string>

namespace koboshi::simulation {
namespace {

std::optional<YamlValue> find_item(const YamlValue& value, const std::string& key) {
  if (value.is_map()) {
    const YamlMap map = value.map();
    return map.has(key) ? std::optional(map.value(key)) : std::nullopt;
  }
  const auto index = parse_integer(key);
  if (!value.is_list() || !index || *index < 0) return std::nullopt;
  const std::vector<YamlValue> items = value.list();
  if (static_cast<std::size_t>(*index) >= items.size()) return std::nullopt;
  return items[static_cast<std::size_t>(*index)];
}

// An override adds missing keys, so an unused pose or a misspelt joint must be detected here.
void collect(const YamlValue& set, const std::optional<YamlValue>& replaced, const std::string& path,
             MotionChoice& motion) {
  const bool is_leaf = !set.is_map();
  if (!replaced || is_leaf == (replaced->is_map() || replaced->is_list())) {
    throw set.error(path, "a number of " + motion.file.filename().string());
  }
  if (is_leaf) {
    static_cast<void>(set.number());
    motion.overrides.push_back({path, set.text(), set.source().string()});
    return;
  }
  for (const auto& [key, value] : set.map().entries()) {
    collect(value, find_item(*replaced, key), path + "." + key, motion);
  }
}

}  // namespace

void read_motion_set(const YamlMap& root, std::vector<MotionChoice>& motions) {
  const auto map = root.optional_child("motion_set");
  if (!map) return;
  for (const auto& [name, set] : map->entries()) {
    const auto motion = std::ranges::find(motions, name, &MotionChoice::name);
    if (motion == motions.end()) throw set.error("the motion " + name, "one of the scenario's motions");
    const YamlFile file(motion->file);
    const YamlMap root_of_file = file.root();
    for (const auto& [key, value] : set.map().entries()) {
      const auto replaced = root_of_file.has(key) ? std::optional(root_of_file.value(key)) : std::nullopt;
      collect(value, replaced, key, *motion);
    }
  }
}

}  // namespace koboshi::simulation
