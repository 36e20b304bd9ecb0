// Animations of the Bit-Bots (bitbots_main, package bitbots_animation_server): `keyframes`, each with its
// duration and pause in s, goals of joints by name in degrees, and `torque`, where 0 releases a joint.

#include <cmath>
#include <numbers>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/motion_files/format/json_file.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

constexpr double kLongest_s = 3'600.0;

std::size_t joint_named(const std::string& name, ForeignMotion& motion) {
  for (std::size_t i = 0; i < motion.joints.size(); ++i) {
    if (motion.joints[i].name == name) return i;
  }
  motion.joints.push_back({.name = name});
  return motion.joints.size() - 1;
}

std::int64_t time_in(const nlohmann::json& frame, const char* key, const std::string& place,
                     ForeignMotion& motion) {
  const auto time_s = number_in(frame, key);
  if (time_s && *time_s >= 0.0 && *time_s <= kLongest_s) return std::llround(1e6 * *time_s);
  if (frame.contains(key)) motion.notes.push_back({place, std::string(key) + " is no time, and read as 0"});
  return 0;
}

}  // namespace

ForeignMotion read_bit_bots(const std::filesystem::path& file, std::string_view text) {
  const nlohmann::json document = parse_json(file, text);
  ForeignMotion motion{.format = MotionFormat::kBitBots, .name = text_in(document, "name")};
  ForeignSection section;
  int number = 0;
  for (const nlohmann::json& item : list_in(file, document, "keyframes")) {
    const std::string place = "keyframe " + std::to_string(++number);
    if (!item.is_object()) {
      motion.notes.push_back({place, "ignored: it is no object"});
      continue;
    }
    ForeignFrame frame{.place = place};
    frame.move_us = time_in(item, "duration", place, motion);
    frame.pause_us = time_in(item, "pause", place, motion);
    if (const auto goals = item.find("goals"); goals != item.end() && goals->is_object()) {
      for (const auto& [name, goal] : goals->items()) {
        const std::size_t joint = joint_named(one_line(name), motion);
        frame.values.resize(motion.joints.size());
        if (goal.is_number() && std::isfinite(goal.get<double>())) {
          frame.values[joint] = kRadPerDegree * goal.get<double>();
        } else {
          motion.notes.push_back(
              {place, "ignored: the goal of " + motion.joints[joint].name + " is no number"});
        }
      }
    }
    if (const auto torques = item.find("torque"); torques != item.end() && torques->is_object()) {
      for (const auto& [name, torque] : torques->items()) {
        if (torque.is_number() && torque.get<double>() == 0.0)
          frame.without_torque.push_back(joint_named(one_line(name), motion));
      }
    }
    section.frames.push_back(std::move(frame));
  }
  if (section.frames.empty()) throw InputError(file, 0, "no keyframe", "at least one");
  for (ForeignFrame& frame : section.frames) frame.values.resize(motion.joints.size());
  motion.sections.push_back(std::move(section));
  return motion;
}

}  // namespace koboshi::tools
