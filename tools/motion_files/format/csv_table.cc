#include "tools/motion_files/format/csv_table.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/text/text.h"
#include "tools/motion_files/format/lines.h"

namespace koboshi::tools {
namespace {

constexpr std::array<char, 3> kSeparators{',', ';', '\t'};

bool is_time(const std::string& name) {
  constexpr std::array<std::string_view, 6> kTimes{"t", "time", "time_s", "time_ms", "t_s", "t_ms"};
  return std::ranges::find(kTimes, lower_case(name)) != kTimes.end();
}

// The separator that `sep=;` names, the first line for spreadsheets.
std::optional<char> named_separator(std::string_view line) {
  if (line.size() >= 2 && line.starts_with('"') && line.ends_with('"'))
    line = line.substr(1, line.size() - 2);
  if (lower_case(line.substr(0, 4)) != "sep=") return std::nullopt;
  // A tab at the end of the line is a blank, which is gone.
  if (line.size() == 4) return '\t';
  if (line.size() != 5 || std::ranges::find(kSeparators, line[4]) == kSeparators.end()) return std::nullopt;
  return line[4];
}

// A unit in brackets as a suffix: "Knee [deg]" and "Knee (deg)" are Knee_deg. Other names stay as they are.
std::string with_unit_suffix(std::string name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kUnits{{{"s", "s"},
                                                                                 {"sec", "s"},
                                                                                 {"seconds", "s"},
                                                                                 {"ms", "ms"},
                                                                                 {"rad", "rad"},
                                                                                 {"radians", "rad"},
                                                                                 {"deg", "deg"},
                                                                                 {"degrees", "deg"},
                                                                                 {"\u00B0", "deg"}}};
  if (!name.ends_with(']') && !name.ends_with(')')) return name;
  const std::string_view all = name;
  const std::size_t open = all.rfind(all.back() == ']' ? '[' : '(');
  if (open == std::string_view::npos) return name;
  const std::string_view own = trimmed(all.substr(0, open));
  const std::string unit = lower_case(trimmed(all.substr(open + 1, all.size() - open - 2)));
  const auto known = std::ranges::find(kUnits, unit, [](const auto& one) { return one.first; });
  if (own.empty() || known == kUnits.end()) return name;
  return std::string(own) + '_' + std::string(known->second);
}

// The names of a header, with the separator behind the time.
std::optional<CsvHeader> header_of(std::string_view line, std::optional<char> separator, std::size_t number) {
  for (const char candidate : kSeparators) {
    if (separator && candidate != *separator) continue;
    std::vector<std::string> names = csv_fields(line, candidate);
    for (std::string& name : names) name = with_unit_suffix(std::move(name));
    if (names.size() >= 2 && is_time(names.front()))
      return CsvHeader{
          .separator = candidate, .names = std::move(names), .line = number, .lines_above = number};
  }
  return std::nullopt;
}

// The field that begins at `rest`, in quotation marks; `rest` then begins behind them.
std::string take_quoted(std::string_view& rest) {
  std::string field;
  std::size_t i = 1;
  for (; i < rest.size(); ++i) {
    if (rest[i] == '"') {
      if (i + 1 == rest.size() || rest[i + 1] != '"') break;
      ++i;
    }
    field += rest[i];
  }
  rest = rest.substr(std::min(i + 1, rest.size()));
  return std::string(trimmed(field));
}

}  // namespace

std::vector<std::string> csv_fields(std::string_view line, char separator) {
  std::vector<std::string> fields;
  while (true) {
    // A tab may be the separator, so that it is no blank here.
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
    std::string field;
    if (line.substr(begin).starts_with('"')) {
      line = line.substr(begin);
      field = take_quoted(line);
    }
    const std::size_t end = std::min(line.find(separator), line.size());
    field += trimmed(line.substr(0, end));
    fields.push_back(std::move(field));
    if (end == line.size()) return fields;
    line = line.substr(end + 1);
  }
}

std::optional<double> csv_number(std::string_view field) {
  if (const auto number = parse_number(field)) return number;
  if (std::ranges::count(field, ',') != 1 || std::ranges::count(field, '.') != 0) return std::nullopt;
  std::string with_point(field);
  std::ranges::replace(with_point, ',', '.');
  return parse_number(with_point);
}

bool is_csv_comment(std::string_view line) {
  return line.empty() || line.starts_with('#') || line.starts_with("//");
}

std::optional<CsvHeader> find_csv_header(std::string_view text) {
  std::optional<char> separator;
  std::optional<CsvHeader> commented;
  std::string_view line;
  for (std::size_t number = 1; take_line(text, line); ++number) {
    line = trimmed(line);
    if (line.starts_with('#')) {
      if (auto header = header_of(trimmed(line.substr(1)), separator, number)) commented = std::move(header);
    }
    if (is_csv_comment(line)) continue;
    if (const auto named = named_separator(line); named && !separator) {
      separator = named;
      continue;
    }
    if (auto header = header_of(line, separator, number)) return header;
    if (!commented || !csv_number(csv_fields(line, commented->separator).front())) return std::nullopt;
    commented->lines_above = number - 1;
    return commented;
  }
  return std::nullopt;
}

}  // namespace koboshi::tools
