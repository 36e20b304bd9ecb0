// Webots reference manual, "Motion": a header `#WEBOTS_MOTION,V1.0,JOINT,...`, then a line for each pose:
// `MM:SS:MMM,NAME,ANGLE,...` in rad, `*` for a joint that the pose leaves alone.

#include <charconv>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

// Minutes, seconds and milliseconds; nothing for any other text. Some programs leave the minutes out.
std::optional<std::int64_t> time_us(std::string_view text) {
  const auto parts = split(text, ':');
  if (parts.size() < 2 || parts.size() > 3) return std::nullopt;
  std::int64_t ms = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto number = parse_integer(parts[i]);
    if (!number || *number < 0 || *number > 100'000) return std::nullopt;
    ms = i + 1 == parts.size() ? ms * 1'000 + *number : ms * 60 + *number;
  }
  return ms * 1'000;
}

void read_header(const std::filesystem::path& file, int line, std::string_view header,
                 ForeignMotion& motion) {
  const auto fields = split(header, ',');
  if (fields.size() < 3)
    throw InputError(file, line, "a header without joints", "#WEBOTS_MOTION,V1.0 and the names of joints");
  if (fields[1] != "V1.0")
    motion.notes.push_back(
        {line_place(static_cast<std::size_t>(line)), "version " + one_line(fields[1]) + " is read as V1.0"});
  for (std::size_t i = 2; i < fields.size(); ++i) {
    if (!fields[i].empty()) motion.joints.push_back({.name = one_line(fields[i])});
  }
}

}  // namespace

ForeignMotion read_webots(const std::filesystem::path& file, std::string_view text) {
  ForeignMotion motion{.format = MotionFormat::kWebots};
  ForeignSection section;
  std::int64_t last_us = 0;
  std::string_view line;
  for (int number = 1; take_line(text, line); ++number) {
    line = trimmed(line);
    const std::string place = line_place(static_cast<std::size_t>(number));
    if (line.empty()) continue;
    if (motion.joints.empty()) {
      read_header(file, number, line, motion);
      continue;
    }
    if (line.starts_with('#')) continue;
    const auto fields = split(line, ',');
    const auto at_us = time_us(fields.front());
    if (!at_us) {
      motion.notes.push_back(
          {place, "ignored: '" + one_line(fields.front()) + "' is no time (minutes:seconds:milliseconds)"});
      continue;
    }
    if (*at_us < last_us) {
      motion.notes.push_back({place, "ignored: its time is before that of the pose above"});
      continue;
    }
    ForeignFrame frame{.place = place, .move_us = *at_us - last_us, .values = {}};
    frame.values.resize(motion.joints.size());
    for (std::size_t joint = 0; joint < motion.joints.size(); ++joint) {
      const std::string_view value = joint + 2 < fields.size() ? fields[joint + 2] : std::string_view("*");
      if (value == "*" || value.empty()) continue;
      frame.values[joint] = parse_number(value);
      if (!frame.values[joint])
        motion.notes.push_back(
            {place, "ignored: '" + one_line(value) + "' is no angle of " + motion.joints[joint].name});
    }
    if (fields.size() < motion.joints.size() + 2)
      motion.notes.push_back(
          {place, "has " + count_text(fields.size() - std::min<std::size_t>(fields.size(), 2), "angle") +
                      " for " + count_text(motion.joints.size(), "joint") + "; the others keep theirs"});
    last_us = *at_us;
    section.frames.push_back(std::move(frame));
  }
  if (section.frames.empty())
    throw InputError(file, 0, "no pose", "lines with a time and the angles of the joints");
  motion.sections.push_back(std::move(section));
  return motion;
}

}  // namespace koboshi::tools
