#include "tools/motion_files/format/roboplus_page.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

namespace koboshi::tools {
namespace {

constexpr double kSpeedUnit_deg_per_s = 720.0 / 256.0;
constexpr double kTick_deg = 300.0 / 1'024.0;  // of an AX-12; the player counts in these ticks
constexpr int kNormalSpeed = 32;
constexpr std::size_t kMostFrames = 512;  // of a motion in the motion language

bool is_used(std::uint16_t position) {
  return (position & (RoboplusStep::kNotUsed | RoboplusStep::kTorqueOff)) == 0;
}

// The time of a step that is given by the speed of the joint which moves farthest.
double time_by_speed_s(const RoboplusStep& from, const RoboplusStep& step) {
  int most = 0;
  for (std::size_t id = 0; id < std::min(from.positions.size(), step.positions.size()); ++id) {
    if (is_used(from.positions[id]) && is_used(step.positions[id]))
      most = std::max(most, std::abs(step.positions[id] - from.positions[id]));
  }
  return step.time > 0.0 ? most * kTick_deg / (step.time * kSpeedUnit_deg_per_s) : 0.0;
}

ForeignSection section_of(const RoboplusPage& page, const RoboplusStep*& last, ForeignMotion& motion) {
  ForeignSection section{.repeat = std::max(page.repeat, 1)};
  const double scale = page.speed > 0 ? static_cast<double>(kNormalSpeed) / page.speed : 1.0;
  int number = 0;
  for (const RoboplusStep& step : page.steps) {
    ForeignFrame frame{.place = "page " + std::to_string(page.number) + ", step " + std::to_string(++number)};
    double time_s = step.time;
    if (page.by_speed) time_s = last != nullptr ? time_by_speed_s(*last, step) : 1.0;
    frame.by_speed = page.by_speed;
    frame.move_us = std::llround(1e6 * scale * time_s);
    frame.pause_us = std::llround(1e6 * scale * step.pause_s);
    frame.values.resize(motion.joints.size());
    for (std::size_t id = 0; id < step.positions.size(); ++id) {
      const std::uint16_t position = step.positions[id];
      if ((position & RoboplusStep::kTorqueOff) != 0) frame.without_torque.push_back(id);
      if (is_used(position)) frame.values[id] = position;
    }
    section.frames.push_back(std::move(frame));
    last = &step;
  }
  return section;
}

// Removes the servos that no step uses, so that nobody needs to say which joints they are.
void drop_unused_servos(ForeignMotion& motion) {
  std::vector<bool> used(motion.joints.size());
  for (const ForeignSection& section : motion.sections) {
    for (const ForeignFrame& frame : section.frames) {
      for (std::size_t id = 0; id < used.size(); ++id) used[id] = used[id] || frame.values[id].has_value();
      for (const std::size_t id : frame.without_torque) used[id] = true;
    }
  }
  std::vector<std::size_t> place(used.size());
  std::vector<ForeignJoint> joints;
  for (std::size_t id = 0; id < used.size(); ++id) {
    place[id] = joints.size();
    if (used[id]) joints.push_back(motion.joints[id]);
  }
  for (ForeignSection& section : motion.sections) {
    for (ForeignFrame& frame : section.frames) {
      std::vector<ForeignValue> values;
      for (std::size_t id = 0; id < used.size(); ++id) {
        if (used[id]) values.push_back(frame.values[id]);
      }
      frame.values = std::move(values);
      for (std::size_t& id : frame.without_torque) id = place[id];
    }
  }
  motion.joints = std::move(joints);
}

}  // namespace

std::vector<ForeignMotion> motions_of(MotionFormat format, const std::vector<RoboplusPage>& pages,
                                      const std::vector<ForeignNote>& notes) {
  std::vector<ForeignMotion> motions;
  for (const RoboplusPage& first : pages) {
    if (first.steps.empty()) continue;
    ForeignMotion motion{
        .format = format, .page = first.number, .name = first.name, .unit = ForeignMotion::Unit::kTicks};
    std::size_t servos = 0;
    for (const RoboplusPage& page : pages) {
      for (const RoboplusStep& step : page.steps) servos = std::max(servos, step.positions.size());
    }
    for (std::size_t id = 0; id < servos; ++id)
      motion.joints.push_back({.name = "servo " + std::to_string(id), .servo_id = static_cast<int>(id)});
    std::set<int> played;
    const RoboplusStep* last = nullptr;
    const RoboplusPage* page = &first;
    std::size_t frames = 0;
    while (page != nullptr && played.insert(page->number).second) {
      frames += page->steps.size();
      if (frames > kMostFrames && page != &first) {
        motion.notes.push_back({"page " + std::to_string(page->number),
                                "is left out with all that follow it: the motion has more than " +
                                    std::to_string(kMostFrames) + " steps"});
        break;
      }
      motion.sections.push_back(section_of(*page, last, motion));
      const int next = page->next;
      const auto found = std::ranges::find_if(
          pages, [&](const RoboplusPage& other) { return other.number == next && !other.steps.empty(); });
      if (next != 0 && (found == pages.end() || played.contains(next)))
        motion.notes.push_back(
            {"page " + std::to_string(page->number),
             "ends here: its next page " + std::to_string(next) +
                 (found == pages.end() ? " is empty"
                                       : " was played before, and the file plays it for ever")});
      page = next != 0 && found != pages.end() ? &*found : nullptr;
    }
    for (const ForeignNote& note : notes) {
      // A note about another page does not concern this motion.
      const bool of_page = note.place.starts_with("page ");
      if (!of_page || std::ranges::any_of(played, [&](int number) {
            return note.place == "page " + std::to_string(number) ||
                   note.place.starts_with("page " + std::to_string(number) + ",");
          }))
        motion.notes.push_back(note);
    }
    drop_unused_servos(motion);
    motions.push_back(std::move(motion));
  }
  return motions;
}

}  // namespace koboshi::tools
