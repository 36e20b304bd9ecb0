#include "tools/motion_files/export.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/flatten.h"
#include "tools/motion_files/format/writers.h"
#include "tools/motion_files/joint_map.h"

namespace koboshi::tools {
namespace {

bool numbers_joints(MotionFormat format) {
  return format == MotionFormat::kPoseSeq || format == MotionFormat::kRoboplusText ||
         format == MotionFormat::kRoboplusPages;
}

bool is_in_ticks(MotionFormat format) {
  return format == MotionFormat::kRoboplusText || format == MotionFormat::kRoboplusPages;
}

bool is_moved(const ForeignMotion& motion, std::size_t joint) {
  for (const ForeignFrame& frame : motion.sections.front().frames) {
    if (frame.values[joint]) return true;
    for (const std::size_t limp : frame.without_torque) {
      if (limp == joint) return true;
    }
  }
  return false;
}

// Replaces the robot's joints by those of the file, in its unit; the robot's joints that do not move are left
// out.
void rename_joints(const std::vector<std::optional<NamedForeignJoint>>& names, ForeignMotion& motion) {
  std::vector<ForeignJoint> joints;
  std::vector<std::optional<std::size_t>> columns(names.size());
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    if (!names[joint]) continue;
    columns[joint] = joints.size();
    joints.push_back(names[joint]->joint);
  }
  for (ForeignFrame& frame : motion.sections.front().frames) {
    std::vector<ForeignValue> values(joints.size());
    std::vector<std::size_t> limp;
    for (std::size_t joint = 0; joint < names.size(); ++joint) {
      if (!columns[joint] || !frame.values[joint]) continue;
      const MappedJoint& mapped = names[joint]->mapped;
      values[*columns[joint]] = mapped.zero + mapped.sign * *frame.values[joint] / mapped.unit_rad;
    }
    for (const std::size_t joint : frame.without_torque) {
      if (columns[joint]) limp.push_back(*columns[joint]);
    }
    frame.values = std::move(values);
    frame.without_torque = std::move(limp);
  }
  motion.joints = std::move(joints);
}

std::string write_as(MotionFormat format, const std::filesystem::path& file, ForeignMotion& motion,
                     const std::string& body) {
  switch (format) {
    case MotionFormat::kWebots:
      return write_webots(motion);
    case MotionFormat::kBitBots:
      return write_bit_bots(motion);
    case MotionFormat::kPoseSeq:
      return write_pose_seq(motion, body);
    case MotionFormat::kRoboplusText:
      return write_roboplus_text(motion);
    case MotionFormat::kRoboplusPages:
      return write_roboplus_pages(file, motion);
    default:
      return write_csv_motion(motion);
  }
}

}  // namespace

std::optional<MotionFormat> writable_format(const std::string& name) {
  constexpr std::array<MotionFormat, 6> kFormats{MotionFormat::kWebots,       MotionFormat::kCsv,
                                                 MotionFormat::kRoboplusText, MotionFormat::kRoboplusPages,
                                                 MotionFormat::kBitBots,      MotionFormat::kPoseSeq};
  for (std::size_t i = 0; i < kFormats.size(); ++i) {
    if (writable_formats()[i] == name) return kFormats.at(i);
  }
  return std::nullopt;
}

const std::vector<std::string>& writable_formats() {
  static const std::vector<std::string> names{"webots", "csv", "mtn", "bin", "bit-bots", "pseq"};
  return names;
}

ExportedMotion export_motion(const simulation::MotionSource& source, MotionFormat format,
                             const sim_board::RobotDescription& robot, const simulation::NamedModel& model,
                             const std::filesystem::path& map_file) {
  ForeignMotion motion = flatten_motion(source, model);
  motion.format = format;
  const bool ticks = is_in_ticks(format);
  motion.unit = ticks ? ForeignMotion::Unit::kTicks : ForeignMotion::Unit::kRadians;
  auto names = foreign_joints(robot, numbers_joints(format), ticks, map_file);
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    if (!is_moved(motion, joint)) {
      names[joint].reset();
    } else if (!names[joint]) {
      throw InputError(source.file, 0, robot.joints[joint].name + ", which has no number",
                       "its koboshi:maker in the robot's file (koboshi model map), or --map FILE");
    }
  }
  if (motion.is_smooth != (format == MotionFormat::kPoseSeq))
    motion.notes.push_back({"motion", motion.is_smooth
                                          ? "its moves are smooth; the format has straight ones"
                                          : "its moves are straight; the format has smooth ones"});
  const auto leans = [](const ForeignFrame& frame) { return frame.lean.has_value(); };
  if (std::ranges::any_of(motion.sections.front().frames, leans))
    motion.notes.push_back({"motion", "declared leans are left out"});
  rename_joints(names, motion);
  ExportedMotion result;
  for (const ForeignFrame& frame : motion.sections.front().frames) {
    ++result.frames;
    result.duration_s += 1e-6 * static_cast<double>(frame.move_us + frame.pause_us);
  }
  result.bytes = write_as(format, source.file, motion, robot.name);
  for (const ForeignNote& note : motion.notes) result.report.push_back(note.place + ": " + note.text);
  return result;
}

}  // namespace koboshi::tools
