#include "tools/plot/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/table/table.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {

Columns make_columns(const std::vector<std::string>& names) {
  Columns columns;
  for (const std::string& name : names) columns.emplace_back(name, std::vector<double>());
  return columns;
}

void add_row(Columns& columns, const std::vector<double>& row) {
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].second.push_back(row.at(i));
}

const std::vector<double>& values_of(const Columns& columns, std::string_view name) {
  const auto found = std::ranges::find(columns, name, &Columns::value_type::first);
  if (found == columns.end()) throw PlotError("no figure: the data have no column " + std::string(name));
  return found->second;
}

void write_csv(const Columns& columns, const std::filesystem::path& file, int digits) {
  Row row;
  for (const auto& [name, values] : columns) row.push_back(name);
  std::string text = csv_line(row);
  for (std::size_t i = 0; i < columns.front().second.size(); ++i) {
    row.clear();
    for (const auto& [name, values] : columns) {
      const bool rounded = digits > 0 && !std::isnan(values[i]);
      row.push_back(rounded ? fmt::format("{:.{}g}", values[i], digits) : csv_cell(values[i]));
    }
    text += csv_line(row);
  }
  write_whole_file(file, text);
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
      points.push_back({x[begin], std::numeric_limits<double>::quiet_NaN()});
      continue;
    }
    const auto [first, second] = std::minmax(lowest, highest);
    points.push_back({x[first], y[first]});
    if (second != first) points.push_back({x[second], y[second]});
  }
  return points;
}

}  // namespace koboshi::tools
