#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace koboshi {

// The one writer of tables: aligned columns for a terminal, Markdown, or CSV (RFC 4180, with \n as line end).
enum class TableStyle { kTerminal, kMarkdown, kCsv };
using Row = std::vector<std::string>;

// Formats one line for the head and one for each row; all have the same number of cells.
[[nodiscard]] std::string table_text(const Row& head, const std::vector<Row>& rows, TableStyle style);

// Formats one line of a CSV file, for files that grow row by row. Cells with a comma, a quote or a line break
// are quoted.
[[nodiscard]] std::string csv_line(const Row& row);

// Returns the cells of such a line, which may end with its line break.
[[nodiscard]] Row csv_cells(std::string_view line);

// Returns the shortest text that reads back as the same number; empty for NaN.
[[nodiscard]] std::string csv_cell(double value);

}  // namespace koboshi
