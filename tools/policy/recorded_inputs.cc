#include "tools/policy/recorded_inputs.h"

#include <algorithm>
#include <string_view>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::tools {
namespace {

std::string_view take_until(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return taken;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> cells;
  for (;;) {
    const bool is_last = line.find(',') == std::string_view::npos;
    cells.push_back(take_until(line, ','));
    if (is_last) return cells;
  }
}

}  // namespace

std::vector<std::vector<double>> read_recorded_columns(const std::filesystem::path& file,
                                                       const std::vector<std::string>& names) {
  const std::string text = read_text_file(file, "a CSV file of recorded inputs");
  std::string_view rest = text;
  const std::vector<std::string_view> header = cells_of(take_until(rest, '\n'));
  std::vector<std::size_t> places;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(header, name);
    if (found == header.end()) {
      const std::vector<std::string> known(header.begin(), header.end());
      throw InputError(file, 1, "no column " + name, expected_names(name, known));
    }
    places.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  std::vector<std::vector<double>> rows;
  for (int line = 2; !rest.empty(); ++line) {
    const std::string_view row = take_until(rest, '\n');
    if (row.empty() || row == "\r") continue;
    const std::vector<std::string_view> cells = cells_of(row);
    std::vector<double> values;
    for (const std::size_t place : places) {
      const auto number = place < cells.size() ? parse_number(cells[place]) : std::nullopt;
      if (!number)
        throw InputError(file, line,
                         "column " + std::string(header[place]) + " = " +
                             (place < cells.size() ? one_line(cells[place]) : "nothing"),
                         "a number");
      values.push_back(*number);
    }
    rows.push_back(std::move(values));
  }
  if (rows.empty()) throw InputError(file, 0, "no rows", "rows of recorded inputs");
  return rows;
}

}  // namespace koboshi::tools
