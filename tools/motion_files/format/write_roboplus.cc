// Writers of ROBOTIS motions: the text of RoboPlus Motion and the 256 pages of a controller. Both have pages
// of at most seven steps, of which one goes on with the next.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/roboplus_page.h"
#include "tools/motion_files/format/writers.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kStepsOfPage = 7;
constexpr std::size_t kServosOfPage = 31;
constexpr std::size_t kBytesOfPage = 512;
constexpr std::size_t kBytesOfStep = 64;  // and of the page's header
constexpr std::size_t kPagesOfFile = 256;
constexpr std::int64_t kPageUnit_us = 8'000;
constexpr int kUnitSpeed = 32;
constexpr double kHighestTick = 4'095.0;

// Returns a position that a servo has; notes one that none has.
int tick_of(double value, const ForeignJoint& joint, ForeignMotion& motion) {
  const double bounded = std::clamp(std::round(value), 0.0, kHighestTick);
  if (std::abs(bounded - value) > 0.5 + 1e-9)
    motion.notes.push_back(
        {joint.name, fmt::format("{:.0f} -> {:.0f}, the end of its range", value, bounded)});
  return static_cast<int>(bounded);
}

// Positions of the text format, which has no joint that keeps its angle: the joint's last position, before
// the first one the first.
std::vector<std::vector<int>> filled_positions(ForeignMotion& motion) {
  const std::vector<ForeignFrame>& frames = motion.sections.front().frames;
  std::vector<std::vector<int>> positions(frames.size(), std::vector<int>(motion.joints.size()));
  for (std::size_t joint = 0; joint < motion.joints.size(); ++joint) {
    const auto first = std::ranges::find_if(
        frames, [&](const ForeignFrame& frame) { return frame.values[joint].has_value(); });
    double last = first == frames.end() ? 2'048.0 : *first->values[joint];
    for (std::size_t i = 0; i < frames.size(); ++i) {
      last = frames[i].values[joint].value_or(last);
      positions[i][joint] = tick_of(last, motion.joints[joint], motion);
    }
  }
  return positions;
}

std::string page_text(const std::string& name, std::size_t next, const std::vector<std::string>& steps) {
  std::string text = "page_begin\nname=" + name + "\ncompliance=";
  for (std::size_t i = 0; i < kServosOfPage; ++i) text += i == 0 ? "5" : " 5";
  text += fmt::format("\nplay_param={} 0 1 1.0 32\n", next);
  for (const std::string& step : steps) text += step;
  return text + "page_end\n";
}

// A page of a controller.
class PageWriter {
 public:
  PageWriter() : bytes_(kBytesOfPage, '\0') {
    byte(15, 1);     // repetitions
    byte(16, 0x0A);  // steps have times
    byte(22, kUnitSpeed);
    byte(24, 32);  // acceleration
    for (std::size_t id = 0; id < kServosOfPage; ++id) byte(32 + id, 0x55);
  }
  void name(const std::string& text) {
    for (std::size_t i = 0; i < std::min<std::size_t>(text.size(), 13); ++i) bytes_[i] = text[i];
  }
  void byte(std::size_t at, int value) { bytes_[at] = static_cast<char>(value); }
  void word(std::size_t at, int value) {
    byte(at, value & 0xFF);
    byte(at + 1, value >> 8);
  }
  std::string finish() {
    byte(31, 0);
    unsigned sum = 0;
    for (const char c : bytes_) sum += static_cast<unsigned char>(c);
    byte(31, static_cast<int>((0xFFU - sum) & 0xFFU));
    return bytes_;
  }

 private:
  std::string bytes_;
};

// The fastest speed at which the longest time of these frames fits a byte. A lower one plays the page more
// slowly.
int speed_for(const std::vector<ForeignFrame>& frames, std::size_t first, std::size_t last) {
  std::int64_t longest_us = 0;
  for (std::size_t i = first; i < last; ++i)
    longest_us = std::max({longest_us, frames[i].move_us, frames[i].pause_us});
  for (int speed = kUnitSpeed; speed > 1; --speed) {
    if (std::llround(static_cast<double>(longest_us * speed) / (kPageUnit_us * kUnitSpeed)) <= 255)
      return speed;
  }
  return 1;
}

}  // namespace

std::string write_roboplus_text(ForeignMotion& motion) {
  const std::vector<std::vector<int>> positions = filled_positions(motion);
  const std::vector<ForeignFrame>& frames = motion.sections.front().frames;
  int last_id = 0;
  for (const ForeignJoint& joint : motion.joints) last_id = std::max(last_id, *joint.servo_id);
  std::vector<std::size_t> columns(static_cast<std::size_t>(last_id) + 1, motion.joints.size());
  for (std::size_t joint = 0; joint < motion.joints.size(); ++joint)
    columns[static_cast<std::size_t>(*motion.joints[joint].servo_id)] = joint;
  std::string text = "type=motion\nversion=1.01\nenable=";
  for (std::size_t id = 0; id < columns.size(); ++id)
    text += std::string(id == 0 ? "" : " ") + (columns[id] < motion.joints.size() ? "1" : "0");
  text += "\n";
  bool has_torque = false;
  for (std::size_t first = 0; first < frames.size(); first += kStepsOfPage) {
    std::vector<std::string> steps;
    const std::size_t last = std::min(first + kStepsOfPage, frames.size());
    for (std::size_t i = first; i < last; ++i) {
      std::string step = "step=";
      for (const std::size_t joint : columns)
        step += std::to_string(joint < motion.joints.size() ? positions[i][joint] : 512) + " ";
      steps.push_back(step + number_text(static_cast<double>(frames[i].pause_us) / 1e6) + " " +
                      number_text(static_cast<double>(frames[i].move_us) / 1e6) + "\n");
      has_torque = has_torque || !frames[i].without_torque.empty();
    }
    text +=
        page_text(first == 0 ? motion.name : "", last < frames.size() ? first / kStepsOfPage + 2 : 0, steps);
  }
  if (has_torque) motion.notes.push_back({"motion", "the format has no joints without torque; they keep it"});
  return text;
}

std::string write_roboplus_pages(const std::filesystem::path& file, ForeignMotion& motion) {
  const std::vector<ForeignFrame>& frames = motion.sections.front().frames;
  if (frames.size() > (kPagesOfFile - 1) * kStepsOfPage)
    throw InputError(file, 0, count_text(frames.size(), "key frame"),
                     "at most 1785, seven on each of 255 pages");
  for (const ForeignJoint& joint : motion.joints) {
    if (*joint.servo_id >= static_cast<int>(kServosOfPage))
      throw InputError(file, 0, joint.name, "servos from 0 to 30 (koboshi:maker, --map)");
  }
  std::string bytes = PageWriter().finish();
  std::int64_t off_us = 0;
  for (std::size_t first = 0; first < frames.size(); first += kStepsOfPage) {
    const std::size_t last = std::min(first + kStepsOfPage, frames.size());
    const int speed = speed_for(frames, first, last);
    PageWriter page;
    if (first == 0) page.name(motion.name);
    page.byte(20, static_cast<int>(last - first));
    page.byte(22, speed);
    if (last < frames.size()) page.byte(25, static_cast<int>(first / kStepsOfPage + 2));
    const auto units = [&](std::int64_t time_us) {
      const std::int64_t count =
          std::llround(static_cast<double>(time_us * speed) / (kPageUnit_us * kUnitSpeed));
      off_us = std::max(off_us, std::abs(count * kPageUnit_us * kUnitSpeed / speed - time_us));
      return static_cast<int>(std::min<std::int64_t>(count, 255));
    };
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t at = kBytesOfStep * (1 + i - first);
      for (std::size_t id = 0; id < kServosOfPage; ++id) page.word(at + 2 * id, RoboplusStep::kNotUsed);
      for (std::size_t joint = 0; joint < motion.joints.size(); ++joint) {
        const ForeignJoint& own = motion.joints[joint];
        const std::size_t place = at + 2 * static_cast<std::size_t>(*own.servo_id);
        if (std::ranges::find(frames[i].without_torque, joint) != frames[i].without_torque.end()) {
          page.word(place, RoboplusStep::kTorqueOff);
        } else if (frames[i].values[joint]) {
          page.word(place, tick_of(*frames[i].values[joint], own, motion));
        }
      }
      page.byte(at + 62, units(frames[i].pause_us));
      page.byte(at + 63, units(frames[i].move_us));
    }
    bytes += page.finish();
  }
  while (bytes.size() < kPagesOfFile * kBytesOfPage) bytes += PageWriter().finish();
  if (off_us > 0)
    motion.notes.push_back({"motion", fmt::format("times are rounded by up to {} ms",
                                                  number_text(static_cast<double>(off_us) / 1e3))});
  return bytes;
}

}  // namespace koboshi::tools
