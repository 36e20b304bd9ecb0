#include "tools/motion_files/joint_map_file.h"

#include <array>
#include <numbers>
#include <string_view>

#include "base/text/text.h"
#include "base/text/user_units.h"

namespace koboshi::tools {

JointMapFile::JointMapFile(const std::filesystem::path& file, const sim_board::RobotDescription& robot) {
  const YamlFile yaml(file);
  const YamlMap root = yaml.root();
  root.require_version(1);
  for (const auto& [name, value] : root.child("joints").entries())
    entries_.emplace_back(name, read(value, robot));
  yaml.finish();
}

bool JointMapFile::find(const ForeignJoint& joint, bool ticks, std::optional<MappedJoint>& mapped) const {
  for (const auto& [name, entry] : entries_) {
    const bool same = name == joint.name || (joint.servo_id && name == std::to_string(*joint.servo_id));
    if (!same) continue;
    mapped.reset();
    if (!entry.ignored) mapped = ticks ? entry.in_ticks : entry.in_rad;
    return true;
  }
  return false;
}

std::optional<NamedForeignJoint> JointMapFile::named(std::size_t joint, bool numbered, bool ticks) const {
  for (const auto& [name, entry] : entries_) {
    if (entry.ignored || entry.in_rad.joint != joint) continue;
    constexpr std::array<std::string_view, 2> kBefore{"servo ", "joint "};
    std::string_view digits = name;
    for (const std::string_view before : kBefore) {
      if (digits.starts_with(before)) digits.remove_prefix(before.size());
    }
    const auto id = parse_integer(digits);
    const bool has_number = id && *id >= 0 && *id <= 254;
    if (numbered != has_number) continue;
    return NamedForeignJoint{
        {.name = name, .servo_id = has_number ? std::optional(static_cast<int>(*id)) : std::nullopt},
        ticks ? entry.in_ticks : entry.in_rad};
  }
  return std::nullopt;
}

JointMapFile::Entry JointMapFile::read(const YamlValue& value, const sim_board::RobotDescription& robot) {
  if (!value.is_map()) {
    if (value.text() != "ignore") throw value.error("a joint with its sign and zero, or 'ignore'");
    return {.ignored = true};
  }
  const YamlMap map = value.map();
  const std::string name = map.text("joint");
  const auto joint = robot.find_joint(name);
  if (!joint) throw map.error_at("joint", "'" + name + "'", "a joint of " + robot.name);
  const auto place = static_cast<std::size_t>(*joint);
  const double sign = static_cast<double>(map.integer("sign", {.min = -1, .max = 1}, 1));
  if (sign == 0.0) throw map.error_at("sign", "0", "1 or -1");
  const double per_turn = map.number("ticks_per_turn", {.min = 1, .max = 1e7}, 4096.0);
  return {
      .in_rad = {place, sign, kRadPerDegree * map.number("zero_deg", {.min = -360, .max = 360}, 0.0), 1.0},
      .in_ticks = {place, sign, map.number("zero_ticks", {.min = -1e6, .max = 1e6}, 0.5 * per_turn),
                   2.0 * std::numbers::pi / per_turn}};
}

}  // namespace koboshi::tools
