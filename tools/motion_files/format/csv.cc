// A table: a column for time and one for each joint. The unit is the end of a column's name (_rad, _deg, _s,
// _ms); without it, angles are degrees if one of them is beyond a turn in rad, and times seconds.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

enum class AngleUnit { kUnknown, kRadians, kDegrees };

struct Column {
  std::string name;
  AngleUnit unit = AngleUnit::kUnknown;
};

bool take_suffix(std::string& name, std::string_view suffix) {
  if (!name.ends_with(suffix) || name.size() == suffix.size()) return false;
  name.resize(name.size() - suffix.size());
  return true;
}

Column joint_column(std::string_view header) {
  Column column{.name = one_line(header)};
  if (take_suffix(column.name, "_rad")) column.unit = AngleUnit::kRadians;
  if (column.unit == AngleUnit::kUnknown &&
      (take_suffix(column.name, "_deg") || take_suffix(column.name, "_degrees")))
    column.unit = AngleUnit::kDegrees;
  return column;
}

char separator_of(std::string_view header) {
  char best = ',';
  for (const char separator : {';', '\t'}) {
    if (std::ranges::count(header, separator) > std::ranges::count(header, best)) best = separator;
  }
  return best;
}

// Angles without a unit are in rad unless one is beyond a whole turn.
void find_units(std::vector<Column>& columns, ForeignMotion& motion) {
  const auto is_unknown = [](const Column& column) { return column.unit == AngleUnit::kUnknown; };
  if (std::ranges::none_of(columns, is_unknown)) return;
  double largest = 0.0;
  for (const ForeignFrame& frame : motion.sections.front().frames) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (is_unknown(columns[i]) && frame.values[i]) largest = std::max(largest, std::abs(*frame.values[i]));
    }
  }
  const bool degrees = largest > 2.0 * std::numbers::pi;
  for (Column& column : columns) {
    if (is_unknown(column)) column.unit = degrees ? AngleUnit::kDegrees : AngleUnit::kRadians;
  }
  motion.notes.push_back({line_place(1), std::string("angles without a unit are read as ") +
                                             (degrees ? "degrees" : "rad") +
                                             "; name the columns JOINT_rad or JOINT_deg to say which"});
}

}  // namespace

ForeignMotion read_csv_motion(const std::filesystem::path& file, std::string_view text) {
  ForeignMotion motion{.format = MotionFormat::kCsv};
  motion.sections.emplace_back();
  std::vector<Column> columns;
  double second = 1.0;
  char separator = ',';
  std::optional<double> last_s;
  std::string_view line;
  for (int number = 1; take_line(text, line); ++number) {
    line = trimmed(line);
    const std::string place = line_place(static_cast<std::size_t>(number));
    if (line.empty() || line.starts_with("//")) continue;
    if (columns.empty()) {
      separator = separator_of(line);
      const auto headers = split(line, separator);
      if (headers.front().ends_with("ms")) second = 1e-3;
      for (std::size_t i = 1; i < headers.size(); ++i) {
        columns.push_back(joint_column(headers[i]));
        motion.joints.push_back({.name = columns.back().name});
      }
      if (columns.empty())
        throw InputError(file, number, "a header without joints", "a time and the names of joints");
      continue;
    }
    const auto fields = split(line, separator);
    const auto time = parse_number(fields.front());
    if (!time || std::abs(*time) > 1e7 || (last_s && second * *time < *last_s)) {
      motion.notes.push_back({place, "ignored: '" + one_line(fields.front()) +
                                         (time ? "' is before the time of the line above" : "' is no time")});
      continue;
    }
    const double at_s = second * *time;
    ForeignFrame frame{.place = place, .values = std::vector<ForeignValue>(columns.size())};
    // The table of a motion begins at 0, so that the first row is the end of the first move; a later one has
    // the clock of a recording.
    constexpr double kLongestFirst_s = 10.0;
    const double from_s = last_s.value_or(at_s > kLongestFirst_s || at_s < 0.0 ? at_s : 0.0);
    frame.move_us = std::llround(1e6 * at_s) - std::llround(1e6 * from_s);
    for (std::size_t i = 0; i < columns.size() && i + 1 < fields.size(); ++i) {
      if (fields[i + 1].empty() || fields[i + 1] == "*") continue;
      frame.values[i] = parse_number(fields[i + 1]);
      if (!frame.values[i])
        motion.notes.push_back(
            {place, "ignored: '" + one_line(fields[i + 1]) + "' is no angle of " + columns[i].name});
    }
    last_s = at_s;
    motion.sections.front().frames.push_back(std::move(frame));
  }
  if (motion.sections.front().frames.empty())
    throw InputError(file, 0, "no line of angles", "a time and angles");
  find_units(columns, motion);
  for (ForeignFrame& frame : motion.sections.front().frames) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (frame.values[i] && columns[i].unit == AngleUnit::kDegrees) *frame.values[i] *= kRadPerDegree;
    }
  }
  return motion;
}

}  // namespace koboshi::tools
