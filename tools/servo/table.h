#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace koboshi::tools {

// Numbers in named columns, on their way to a CSV file. What is not a number (NaN) is an empty cell.
class Table {
 public:
  explicit Table(const std::vector<std::string>& columns);

  void add(const std::vector<double>& row);
  // Throws std::system_error.
  void write(const std::filesystem::path& csv_file) const;

 private:
  std::string text_;
};

}  // namespace koboshi::tools
