// A table: a column for time and one for each joint. The unit is the end of a column's name (_rad, _deg, _s,
// _ms); without it, angles are degrees if one of them is beyond a turn in rad, and times seconds.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/motion_files/format/csv_table.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

enum class AngleUnit { kUnknown, kRadians, kDegrees };

struct Column {
  std::string name;
  std::size_t field;  // of a row
  AngleUnit unit = AngleUnit::kUnknown;
};

bool take_suffix(std::string& name, std::string_view suffix) {
  if (!lower_case(name).ends_with(suffix) || name.size() == suffix.size()) return false;
  name.resize(name.size() - suffix.size());
  return true;
}

Column joint_column(std::string_view header, std::size_t field) {
  Column column{.name = one_line(header), .field = field};
  if (take_suffix(column.name, "_rad")) column.unit = AngleUnit::kRadians;
  if (column.unit == AngleUnit::kUnknown &&
      (take_suffix(column.name, "_deg") || take_suffix(column.name, "_degrees")))
    column.unit = AngleUnit::kDegrees;
  return column;
}

// The columns of joints; a column without a name is none.
std::vector<Column> joint_columns(const CsvHeader& header) {
  std::vector<Column> columns;
  for (std::size_t i = 1; i < header.names.size(); ++i) {
    if (!header.names[i].empty()) columns.push_back(joint_column(header.names[i], i));
  }
  return columns;
}

// Names the first field in a column without a name. Returns whether there is one.
bool note_nameless(const CsvHeader& header, const std::vector<std::string>& fields, const std::string& place,
                   ForeignMotion& motion) {
  for (std::size_t i = 1; i < fields.size(); ++i) {
    if (fields[i].empty() || (i < header.names.size() && !header.names[i].empty())) continue;
    motion.notes.push_back({place, "ignored: '" + one_line(fields[i]) + "' in column " +
                                       std::to_string(i + 1) + ", which has no name, and further ones"});
    return true;
  }
  return false;
}

// Angles without a unit are in rad unless one is beyond a whole turn.
void find_units(std::vector<Column>& columns, std::size_t header_line, ForeignMotion& motion) {
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
  motion.notes.push_back({line_place(header_line),
                          std::string("angles without a unit are read as ") + (degrees ? "degrees" : "rad") +
                              "; name the columns JOINT_rad or JOINT_deg to say which"});
}

}  // namespace

ForeignMotion read_csv_motion(const std::filesystem::path& file, std::string_view text) {
  // The table of a motion begins at 0, so that the first row is the end of the first move; a later one has
  // the clock of a recording.
  constexpr double kLongestFirst_s = 10.0;
  const auto header = find_csv_header(text);
  if (!header) throw InputError(file, 0, "no header of a table", "a time and the names of joints");
  ForeignMotion motion{.format = MotionFormat::kCsv};
  std::vector<ForeignFrame>& frames = motion.sections.emplace_back().frames;
  std::vector<Column> columns = joint_columns(*header);
  if (columns.empty())
    throw InputError(file, static_cast<int>(header->line), "a header without joints",
                     "a time and the names of joints");
  for (const Column& column : columns) motion.joints.push_back({.name = column.name});
  const double second = lower_case(header->names.front()).ends_with("ms") ? 1e-3 : 1.0;
  std::optional<double> last_s;
  bool nameless_noted = false;
  std::string_view line;
  for (std::size_t number = 1; take_line(text, line); ++number) {
    line = trimmed(line);
    if (number <= header->lines_above || is_csv_comment(line)) continue;
    const std::string place = line_place(number);
    const auto fields = csv_fields(line, header->separator);
    const auto time = csv_number(fields.front());
    if (!time || std::abs(*time) > 1e7 || (last_s && second * *time < *last_s)) {
      motion.notes.push_back({place, "ignored: '" + one_line(fields.front()) +
                                         (time ? "' is before the time of the line above" : "' is no time")});
      continue;
    }
    const double at_s = second * *time;
    const bool has_clock = !last_s && (at_s > kLongestFirst_s || at_s < 0.0);
    if (has_clock)
      motion.notes.push_back({place, "the motion begins here, at " + number_text(at_s) +
                                         " s: only a first time from 0 to 10 s is that of the first move"});
    const double from_s = last_s.value_or(has_clock ? at_s : 0.0);
    ForeignFrame frame{.place = place, .values = std::vector<ForeignValue>(columns.size())};
    frame.move_us = std::llround(1e6 * at_s) - std::llround(1e6 * from_s);
    for (std::size_t i = 0; i < columns.size() && columns[i].field < fields.size(); ++i) {
      const std::string& field = fields[columns[i].field];
      if (field.empty() || field == "*") continue;
      frame.values[i] = csv_number(field);
      if (!frame.values[i])
        motion.notes.push_back(
            {place, "ignored: '" + one_line(field) + "' is no angle of " + columns[i].name});
    }
    nameless_noted = nameless_noted || note_nameless(*header, fields, place, motion);
    last_s = at_s;
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw InputError(file, 0, "no line of angles", "a time and angles");
  find_units(columns, header->line, motion);
  for (ForeignFrame& frame : frames) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (frame.values[i] && columns[i].unit == AngleUnit::kDegrees) *frame.values[i] *= kRadPerDegree;
    }
  }
  return motion;
}

}  // namespace koboshi::tools
