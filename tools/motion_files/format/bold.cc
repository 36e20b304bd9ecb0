// Motion scripts of bold-humanoid (DARwIn-OP with MX-28): stages with repetitions, in them key frames. A move
// and a pause count cycles of 8 ms. Values are positions of 4,096 ticks a turn by joint; a name without its
// side is the value of the left joint, and the right one has its mirror image about 2,048.

#include <array>
#include <cmath>
#include <string>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/json_file.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

constexpr std::int64_t kCycle_us = 8'000;
constexpr double kMostCycles = 100'000;
constexpr double kTurn_ticks = 4'096.0;

// The joints by servo id, from 1. Right and left alternate up to the ankles.
constexpr std::array<const char*, 20> kServos{"shoulder-pitch-right",
                                              "shoulder-pitch-left",
                                              "shoulder-roll-right",
                                              "shoulder-roll-left",
                                              "elbow-right",
                                              "elbow-left",
                                              "hip-yaw-right",
                                              "hip-yaw-left",
                                              "hip-roll-right",
                                              "hip-roll-left",
                                              "hip-pitch-right",
                                              "hip-pitch-left",
                                              "knee-right",
                                              "knee-left",
                                              "ankle-pitch-right",
                                              "ankle-pitch-left",
                                              "ankle-roll-right",
                                              "ankle-roll-left",
                                              "head-pan",
                                              "head-tilt"};

// The letters of a name, its side last: some files have the side first, or other signs between the words.
std::string plain(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') letters += static_cast<char>(c + 32);
    if (c >= 'a' && c <= 'z') letters += c;
  }
  for (const std::string_view side : {"left", "right"}) {
    if (letters.starts_with(side)) letters = letters.substr(side.size()) + std::string(side);
  }
  return letters;
}

std::optional<std::size_t> servo_named(const std::string& name) {
  for (std::size_t i = 0; i < kServos.size(); ++i) {
    if (plain(kServos[i]) == plain(name)) return i;
  }
  return std::nullopt;
}

void set(const std::string& name, double ticks, ForeignFrame& frame, ForeignMotion& motion) {
  if (const auto servo = servo_named(name)) {
    frame.values[*servo] = ticks;
    return;
  }
  const auto left = servo_named(name + "-left");
  const auto right = servo_named(name + "-right");
  if (left && right) {
    frame.values[*left] = ticks;
    frame.values[*right] = kTurn_ticks - ticks;
    return;
  }
  motion.notes.push_back({frame.place, "ignored: '" + one_line(name) + "' is no joint of a DARwIn-OP"});
}

std::int64_t cycles_us(const nlohmann::json& frame, const char* key, const std::string& place,
                       ForeignMotion& motion) {
  const auto cycles = number_in(frame, key);
  if (cycles && *cycles >= 0.0 && *cycles <= kMostCycles) return std::llround(*cycles) * kCycle_us;
  if (frame.contains(key))
    motion.notes.push_back({place, std::string(key) + " is no number of cycles, and read as 0"});
  return 0;
}

ForeignFrame read_frame(const nlohmann::json& item, const std::string& place, ForeignMotion& motion) {
  ForeignFrame frame{.place = place, .values = std::vector<ForeignValue>(kServos.size())};
  frame.move_us = cycles_us(item, "moveCycles", place, motion);
  frame.pause_us = cycles_us(item, "pauseCycles", place, motion);
  const auto values = item.find("values");
  if (values == item.end()) return frame;
  std::size_t number = 0;
  for (const auto& [name, value] : values->items()) {
    if (!value.is_number()) {
      motion.notes.push_back({place, "ignored: the value of " + one_line(name) + " is no number"});
    } else if (values->is_object()) {
      set(name, value.get<double>(), frame, motion);
    } else if (number < kServos.size()) {
      frame.values[number] = value.get<double>();
    }
    ++number;
  }
  return frame;
}

}  // namespace

ForeignMotion read_bold(const std::filesystem::path& file, std::string_view text) {
  const nlohmann::json document = parse_json(file, text);
  ForeignMotion motion{
      .format = MotionFormat::kBold, .name = text_in(document, "name"), .unit = ForeignMotion::Unit::kTicks};
  for (std::size_t i = 0; i < kServos.size(); ++i)
    motion.joints.push_back({.name = kServos[i], .servo_id = static_cast<int>(i) + 1});
  int stage_number = 0;
  for (const nlohmann::json& stage : list_in(file, document, "stages")) {
    const std::string stage_place = "stage " + std::to_string(++stage_number);
    if (!stage.is_object()) {
      motion.notes.push_back({stage_place, "ignored: it is no object"});
      continue;
    }
    ForeignSection section;
    const double repeat = number_in(stage, "repeat").value_or(1.0);
    if (repeat >= 1.0 && repeat <= 65'535.0) section.repeat = static_cast<int>(repeat);
    if (stage.contains("pGains"))
      motion.notes.push_back({stage_place, "its position gains are ignored: the motion language has none"});
    const auto frames = stage.find("keyFrames");
    int number = 0;
    const nlohmann::json none = nlohmann::json::array();
    for (const nlohmann::json& item : frames != stage.end() && frames->is_array() ? *frames : none) {
      const std::string place = stage_place + ", key frame " + std::to_string(++number);
      if (item.is_object()) section.frames.push_back(read_frame(item, place, motion));
    }
    if (!section.frames.empty()) motion.sections.push_back(std::move(section));
  }
  if (motion.sections.empty()) throw InputError(file, 0, "no key frame", "at least one");
  return motion;
}

}  // namespace koboshi::tools
