// Choreonoid, PoseSeq plugin: `refs`, each with the time in s at which a pose is reached, and the pose:
// joints by their numbers in the body, angles `q` in rad. The player passes through the poses on splines.

#include <algorithm>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_reader.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

constexpr double kLongestSequence_s = 36'000.0;
constexpr std::int64_t kMostJoints = 255;

std::size_t joint_numbered(std::int64_t id, ForeignMotion& motion) {
  for (std::size_t i = 0; i < motion.joints.size(); ++i) {
    if (motion.joints[i].servo_id == static_cast<int>(id)) return i;
  }
  motion.joints.push_back({.name = "joint " + std::to_string(id), .servo_id = static_cast<int>(id)});
  return motion.joints.size() - 1;
}

// Reads the joints of a pose. False if it is no pose of joints.
bool read_pose(const YamlMap& pose, ForeignFrame& frame, ForeignMotion& motion) {
  if (!pose.has("joints") || !pose.has("q")) return false;
  const auto joints = pose.list("joints");
  const auto angles = pose.list("q");
  if (joints.size() != angles.size())
    motion.notes.push_back({frame.place, "has " + count_text(joints.size(), "joint") + " and " +
                                             count_text(angles.size(), "angle")});
  for (std::size_t i = 0; i < std::min(joints.size(), angles.size()); ++i) {
    const std::size_t joint = joint_numbered(joints[i].integer({.min = 0, .max = kMostJoints}), motion);
    frame.values.resize(motion.joints.size());
    frame.values[joint] = angles[i].number({.min = -1e4, .max = 1e4});
  }
  return true;
}

// A transition that may take less than the time since the pose above begins later: that pose waits.
void wait_before_short_transition(const YamlMap& ref, ForeignFrame& frame, ForeignSection& section) {
  constexpr const char* kKey = "maxTransitionTime";
  if (section.frames.empty() || !ref.has(kKey)) return;
  const std::int64_t limit_us = std::llround(1e6 * ref.number(kKey, {.min = 0.0, .max = kLongestSequence_s}));
  if (limit_us == 0 || limit_us >= frame.move_us) return;  // 0: no limit
  section.frames.back().pause_us += frame.move_us - limit_us;
  frame.move_us = limit_us;
}

}  // namespace

ForeignMotion read_pose_seq(const std::filesystem::path& file, std::string_view text) {
  const YamlFile document(file, parse_yaml(std::string(text), file));
  const YamlMap root = document.root();
  ForeignMotion motion{.format = MotionFormat::kPoseSeq, .is_smooth = true};
  if (root.has("name")) motion.name = one_line(root.text("name"));
  ForeignSection section;
  double last_s = 0.0;
  bool has_stationary = false;
  for (const YamlValue& item : root.list("refs")) {
    const YamlMap ref = item.map();
    ForeignFrame frame{.place = "line " + std::to_string(item.line())};
    const double at_s = ref.number("time", {.min = 0.0, .max = kLongestSequence_s});
    if (!ref.has("refer") || !ref.value("refer").is_map() || !read_pose(ref.child("refer"), frame, motion)) {
      motion.notes.push_back({frame.place, "ignored: it refers to something other than a pose of joints"});
      continue;
    }
    has_stationary = has_stationary || ref.child("refer").has("isZmpStationaryPoint");
    if (at_s < last_s) {
      motion.notes.push_back({frame.place, "ignored: its time is before that of the pose above"});
      continue;
    }
    // The last of several poses at one time counts, for the joints that it has.
    if (!section.frames.empty() && at_s == last_s) {
      const ForeignFrame& before = section.frames.back();
      motion.notes.push_back({frame.place, "replaces the angles of the pose above, which has the same time"});
      frame.values.resize(std::max(frame.values.size(), before.values.size()));
      for (std::size_t i = 0; i < before.values.size(); ++i) {
        if (!frame.values[i]) frame.values[i] = before.values[i];
      }
      frame.move_us = before.move_us;
      section.frames.pop_back();
    } else {
      frame.move_us = std::llround(1e6 * at_s) - std::llround(1e6 * last_s);
      wait_before_short_transition(ref, frame, section);
    }
    last_s = at_s;
    section.frames.push_back(std::move(frame));
  }
  if (section.frames.empty()) throw InputError(file, 0, "no pose", "at least one in refs");
  if (has_stationary)
    motion.notes.push_back(
        {"refs",
         "stationary points of the ZMP are ignored: Choreonoid corrects the waist by them when it plays"});
  for (ForeignFrame& frame : section.frames) frame.values.resize(motion.joints.size());
  motion.sections.push_back(std::move(section));
  return motion;
}

}  // namespace koboshi::tools
