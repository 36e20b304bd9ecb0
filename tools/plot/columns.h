#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace koboshi::tools {

// Named columns of one length: the data of a figure, and of a CSV file. NaN where there is no value.
using Columns = std::vector<std::pair<std::string, std::vector<double>>>;

// Columns without rows.
Columns make_columns(const std::vector<std::string>& names);
// Appends a value to each column, in their order.
void add_row(Columns& columns, const std::vector<double>& row);
// The values of a column. Throws PlotError where there is none of this name.
const std::vector<double>& values_of(const Columns& columns, std::string_view name);
// Writes a header line and a line per row, with an empty cell for NaN. Numbers have this many significant
// digits, or with 0 as few as read back the same. Throws WriteError.
void write_csv(const Columns& columns, const std::filesystem::path& file, int digits = 0);

struct Point {
  double x = 0.0;
  double y = 0.0;

  friend bool operator==(const Point&, const Point&) = default;
};

// The curve with at most two points in each of `buckets` equal runs of samples: its smallest and its largest,
// in their order. A run without any number becomes one point that is not a number, which breaks the line.
// Both spans are of one length.
std::vector<Point> thin(std::span<const double> x, std::span<const double> y, std::size_t buckets);

}  // namespace koboshi::tools
