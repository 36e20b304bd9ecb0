#include "tools/lab/plot/columns.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"

namespace koboshi::tools {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string_view> split(std::string_view line, std::vector<std::string_view> cells) {
  cells.clear();
  if (line.ends_with('\r')) line.remove_suffix(1);
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

// One column on its way from the file.
struct Wanted {
  std::size_t index;
  std::vector<double>* values;
};

std::vector<Wanted> find_columns(const std::filesystem::path& file, std::span<const std::string_view> header,
                                 std::span<const std::string> names, Columns& columns) {
  std::vector<Wanted> wanted;
  for (const std::string& name : names) {
    const auto cell = std::ranges::find(header, name);
    if (cell == header.end()) throw sim::InputError(file, 1, "no column " + name, "a header that names it");
    if (columns.contains(name)) continue;
    wanted.push_back({static_cast<std::size_t>(cell - header.begin()), &columns[name]});
  }
  return wanted;
}

}  // namespace

Columns read_columns(const std::filesystem::path& csv_file, std::span<const std::string> names) {
  std::ifstream stream(csv_file);
  std::string line;
  if (!std::getline(stream, line)) throw sim::InputError(csv_file, 0, "no header", "a CSV file");
  Columns columns;
  std::vector<std::string_view> cells = split(line, {});
  const std::size_t width = cells.size();
  const std::vector<Wanted> wanted = find_columns(csv_file, cells, names, columns);
  for (int number = 2; std::getline(stream, line); ++number) {
    cells = split(line, std::move(cells));
    if (cells.size() != width) {
      throw sim::InputError(csv_file, number, std::to_string(cells.size()) + " cells", std::to_string(width));
    }
    for (const Wanted& column : wanted) {
      const std::string_view cell = cells[column.index];
      const auto value = cell.empty() ? std::optional(kNotANumber) : sim::parse_number(cell);
      if (!value) throw sim::InputError(csv_file, number, sim::one_line(cell), "a number");
      column.values->push_back(*value);
    }
  }
  return columns;
}

std::vector<Point> thin(std::span<const double> x, std::span<const double> y, std::size_t buckets) {
  std::vector<Point> points;
  const std::size_t size = x.size();
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const std::size_t begin = bucket * size / buckets;
    const std::size_t end = (bucket + 1) * size / buckets;
    std::size_t lowest = end;
    std::size_t highest = end;
    for (std::size_t i = begin; i < end; ++i) {
      if (std::isnan(y[i])) continue;
      if (lowest == end || y[i] < y[lowest]) lowest = i;
      if (highest == end || y[i] > y[highest]) highest = i;
    }
    if (begin == end) continue;
    if (lowest == end) {
      points.push_back({x[begin], kNotANumber});
      continue;
    }
    const auto [first, second] = std::minmax(lowest, highest);
    points.push_back({x[first], y[first]});
    if (second != first) points.push_back({x[second], y[second]});
  }
  return points;
}

}  // namespace koboshi::tools
