#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace koboshi::tools {

using Columns = std::map<std::string, std::vector<double>>;

// The named columns of a CSV file with one header line; an empty cell is not a number (NaN). Throws
// sim::InputError with the line where a column is missing, a line is short or a cell is no number.
Columns read_columns(const std::filesystem::path& csv_file, std::span<const std::string> names);

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
