#include "simulation/gait/gait.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/text/user_units.h"
#include "base/yaml/yaml_reader.h"
#include "simulation/gait/gait_keys.h"

namespace koboshi::simulation {
namespace {

// Keys that have been renamed. Error messages for the old key give the new one.
struct RenamedKey {
  const char* old_key;
  const char* key;
};
constexpr std::array<RenamedKey, 2> kRenamedKeys{
    {{"swing_ease", "swing_profile"}, {"zmp_ahead_m", "zmp_forward_m"}}};

void check_renamed(const YamlMap& root) {
  for (const auto& [old_key, key] : kRenamedKeys) {
    if (root.has(old_key))
      throw root.error_at(old_key, std::string("key ") + old_key + ", which has another name now", key);
  }
}

const GaitKey kGaitKeys[]{
    {.key = "points",
     .min = 2.0,
     .max = 64.0,
     .fallback = 8.0,
     .is_integer = true,
     .meaning =
         "number of points in a cycle of two steps; joints move linearly between them (the paper's figure 6)",
     .set = [](Gait& g, double v) { g.points = static_cast<int>(v); }},
    {.key = "period_s",
     .unit = "s",
     .min = 0.1,
     .max = 10.0,
     .meaning = "duration of the cycle",
     .set = [](Gait& g, double v) { g.period_s = v; }},
    {.key = "step_length_m",
     .unit = "m",
     .min = -0.5,
     .max = 0.5,
     .meaning = "distance by which a foot lands in front of the other; negative: backwards",
     .set = [](Gait& g, double v) { g.step_length_m = v; }},
    {.key = "step_width_m",
     .unit = "m",
     .min = 0.001,
     .max = 1.0,
     .meaning = "distance between the centre lines of the soles",
     .set = [](Gait& g, double v) { g.step_width_m = v; }},
    {.key = "step_height_m",
     .unit = "m",
     .min = 0.0,
     .max = 0.5,
     .meaning = "largest height of the swing foot's sole",
     .set = [](Gait& g, double v) { g.step_height_m = v; }},
    {.key = "swing_profile",
     .min = 0.0,
     .max = 1.0,
     .fallback = 0.5,
     .meaning = "1: the swing foot lifts off and lands without forward speed (a cycloid), 0: its forward "
                "speed is constant",
     .set = [](Gait& g, double v) { g.swing_profile = v; }},
    {.key = "com_height_m",
     .unit = "m",
     .min = 0.01,
     .max = 2.0,
     .meaning = "height of the centre of mass above the ground: z of the pendulum",
     .set = [](Gait& g, double v) { g.com_height_m = v; }},
    {.key = "double_support",
     .min = 0.01,
     .max = 0.9,
     .meaning = "share of a step in which the ZMP moves from foot to foot",
     .set = [](Gait& g, double v) { g.double_support = v; }},
    {.key = "trunk_pitch_deg",
     .unit = "deg",
     .min = -45.0,
     .max = 45.0,
     .fallback = 0.0,
     .meaning = "forward lean of the trunk",
     .set = [](Gait& g, double v) { g.trunk_pitch_rad = kRadPerDegree * v; }},
    {.key = "zmp_forward_m",
     .unit = "m",
     .min = -0.2,
     .max = 0.2,
     .fallback = 0.0,
     .meaning = "distance of the planned ZMP in front of the ankle",
     .set = [](Gait& g, double v) { g.zmp_forward_m = v; }},
    {.key = "zmp_inward_m",
     .unit = "m",
     .min = -0.2,
     .max = 0.2,
     .fallback = 0.0,
     .meaning = "distance of the planned ZMP from the sole's centre line towards the other foot",
     .set = [](Gait& g, double v) { g.zmp_inward_m = v; }},
    {.key = "sag_compensation",
     .min = 0.0,
     .max = 2.0,
     .fallback = 0.0,
     .meaning = "share of the servos' deflection under the robot's weight that the targets compensate for",
     .set = [](Gait& g, double v) { g.sag_compensation = v; }},
    {.key = "start_steps",
     .min = 0.0,
     .max = 20.0,
     .fallback = 2.0,
     .is_integer = true,
     .meaning = "number of steps that grow from standing to the full length, and shrink again at the end",
     .set = [](Gait& g, double v) { g.start_steps = static_cast<int>(v); }},
    {.key = "feedback.ankle_pitch_s",
     .unit = "s",
     .min = -1.0,
     .max = 1.0,
     .fallback = 0.0,
     .meaning = "gain of the firmware's gyro feedback, of the trunk's pitch rate at the ankles",
     .set = [](Gait& g, double v) { g.feedback.ankle_pitch_s = v; }},
    {.key = "feedback.ankle_roll_s",
     .unit = "s",
     .min = -1.0,
     .max = 1.0,
     .fallback = 0.0,
     .meaning = "gain of the firmware's gyro feedback, of the trunk's roll rate at the ankles",
     .set = [](Gait& g, double v) { g.feedback.ankle_roll_s = v; }},
    {.key = "feedback.hip_roll_s",
     .unit = "s",
     .min = -1.0,
     .max = 1.0,
     .fallback = 0.0,
     .meaning = "gain of the firmware's gyro feedback, of the trunk's roll rate at the hips",
     .set = [](Gait& g, double v) { g.feedback.hip_roll_s = v; }},
    {.key = "feedback.knee_s",
     .unit = "s",
     .min = -1.0,
     .max = 1.0,
     .fallback = 0.0,
     .meaning = "gain of the firmware's gyro feedback, of the trunk's pitch rate at the knees",
     .set = [](Gait& g, double v) { g.feedback.knee_s = v; }},
};

void read_numbers(const YamlMap& root, Gait& gait) {
  constexpr std::string_view kFeedback = "feedback.";
  const auto feedback = root.optional_child("feedback");
  for (const GaitKey& key : gait_keys()) {
    const bool is_nested = key.key.starts_with(kFeedback);
    if (is_nested && !feedback) continue;
    const YamlMap& map = is_nested ? *feedback : root;
    const std::string name(is_nested ? key.key.substr(kFeedback.size()) : key.key);
    if (key.is_integer) {
      const IntegerRange range{static_cast<std::int64_t>(key.min), static_cast<std::int64_t>(key.max)};
      const auto fallback =
          key.fallback ? std::optional(static_cast<std::int64_t>(*key.fallback)) : std::nullopt;
      key.set(gait, static_cast<double>(map.integer(name, range, fallback)));
    } else {
      key.set(gait, map.number(name, {.min = key.min, .max = key.max}, key.fallback));
    }
  }
}

void read_upper_body(const YamlMap& root, Gait& gait) {
  const auto map = root.optional_child("upper_body_deg");
  if (!map) return;
  for (const auto& [joint, value] : map->entries()) {
    gait.upper_body.push_back(
        {joint, value.line(), kRadPerDegree * value.number({.min = -180.0, .max = 180.0})});
  }
}

}  // namespace

std::span<const GaitKey> gait_keys() { return kGaitKeys; }

Gait read_gait(const std::filesystem::path& file, std::span<const Override> overrides) {
  return read_gait(YamlFile(file, overrides));
}

Gait read_gait(const YamlFile& yaml) {
  const YamlMap root = yaml.root();
  root.require_version(1);
  check_renamed(root);
  Gait gait;
  gait.file = yaml.path();
  gait.robot = root.text("robot");
  read_numbers(root, gait);
  read_upper_body(root, gait);
  yaml.finish();
  return gait;
}

}  // namespace koboshi::simulation
