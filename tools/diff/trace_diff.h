#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace koboshi::tools {

// A cell of trace.csv in two runs.
struct CellDifference {
  std::string column;
  std::string a;
  std::string b;

  friend bool operator==(const CellDifference&, const CellDifference&) = default;
};

// The first line in which two traces differ.
struct TraceDifference {
  int line = 0;                       // 1 for the header
  std::string time_s;                 // first cell of the line, in the longer trace if one has ended
  std::vector<CellDifference> cells;  // cells that differ; none if a trace ends before the line
  std::optional<char> ended;          // 'A' or 'B': the run that ends before the line
};

// Compares the texts: numbers are equal only if all their digits are. Throws InputError if a file cannot
// be read, is empty, or has a line with too many or too few cells.
std::optional<TraceDifference> compare_traces(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace koboshi::tools
