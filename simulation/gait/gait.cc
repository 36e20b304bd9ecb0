#include "simulation/gait/gait.h"

#include <array>
#include <string>

#include "sim_board/input/user_units.h"
#include "sim_board/input/yaml_reader.h"

namespace koboshi::simulation {
namespace {

// Keys that have been renamed. Error messages for the old key give the new one.
struct RenamedKey {
  const char* old_key;
  const char* key;
};
constexpr std::array<RenamedKey, 2> kRenamedKeys{
    {{"swing_ease", "swing_profile"}, {"zmp_ahead_m", "zmp_forward_m"}}};

void check_renamed(const sim::YamlMap& root) {
  for (const auto& [old_key, key] : kRenamedKeys) {
    if (root.has(old_key))
      throw root.error_at(old_key, std::string("key ") + old_key + ", which has another name now", key);
  }
}

void read_pattern(const sim::YamlMap& root, Gait& gait) {
  gait.points = static_cast<int>(root.integer("points", {.min = 2, .max = 64}, gait.points));
  gait.period_s = root.number("period_s", {.min = 0.1, .max = 10.0});
  gait.step_length_m = root.number("step_length_m", {.min = -0.5, .max = 0.5});
  gait.step_width_m = root.number("step_width_m", {.min = 0.001, .max = 1.0});
  gait.step_height_m = root.number("step_height_m", {.min = 0.0, .max = 0.5});
  gait.swing_profile = root.number("swing_profile", {.min = 0.0, .max = 1.0}, gait.swing_profile);
  gait.com_height_m = root.number("com_height_m", {.min = 0.01, .max = 2.0});
  gait.double_support = root.number("double_support", {.min = 0.01, .max = 0.9});
  gait.trunk_pitch_rad =
      sim::kRadPerDegree * root.number("trunk_pitch_deg", {.min = -45.0, .max = 45.0}, 0.0);
  gait.zmp_forward_m = root.number("zmp_forward_m", {.min = -0.2, .max = 0.2}, 0.0);
  gait.zmp_inward_m = root.number("zmp_inward_m", {.min = -0.2, .max = 0.2}, 0.0);
  gait.sag_compensation = root.number("sag_compensation", {.min = 0.0, .max = 2.0}, 0.0);
  gait.start_steps = static_cast<int>(root.integer("start_steps", {.min = 0, .max = 20}, gait.start_steps));
}

void read_upper_body(const sim::YamlMap& root, Gait& gait) {
  const auto map = root.optional_child("upper_body_deg");
  if (!map) return;
  for (const auto& [joint, value] : map->entries()) {
    gait.upper_body.push_back(
        {joint, value.line(), sim::kRadPerDegree * value.number({.min = -180.0, .max = 180.0})});
  }
}

void read_feedback(const sim::YamlMap& root, GyroFeedbackGains& gains) {
  const auto map = root.optional_child("feedback");
  if (!map) return;
  const auto gain = [&](const char* key) { return map->number(key, {.min = -1.0, .max = 1.0}, 0.0); };
  gains = {gain("ankle_pitch_s"), gain("ankle_roll_s"), gain("hip_roll_s"), gain("knee_s")};
}

}  // namespace

Gait read_gait(const std::filesystem::path& file, std::span<const sim::Override> overrides) {
  const sim::YamlFile yaml(file, overrides);
  const sim::YamlMap root = yaml.root();
  root.require_version(1);
  check_renamed(root);
  Gait gait;
  gait.file = file;
  gait.robot = root.text("robot");
  read_pattern(root, gait);
  read_upper_body(root, gait);
  read_feedback(root, gait.feedback);
  yaml.finish();
  return gait;
}

}  // namespace koboshi::simulation
