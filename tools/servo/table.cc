#include "tools/servo/table.h"

#include <cmath>

#include <fmt/format.h>

#include "sim_board/record/output_file.h"

namespace koboshi::tools {

Table::Table(const std::vector<std::string>& columns) : text_(fmt::format("{}\n", fmt::join(columns, ","))) {}

void Table::add(const std::vector<double>& row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) text_ += ',';
    if (!std::isnan(row[i])) text_ += fmt::format("{:.6g}", row[i]);
  }
  text_ += '\n';
}

void Table::write(const std::filesystem::path& csv_file) const { sim::write_whole_file(csv_file, text_); }

}  // namespace koboshi::tools
