#include "base/table/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"

namespace koboshi {
namespace {

// Quotes a cell that contains a separator, a quote or a line break.
std::string quoted_cell(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char letter : cell) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

std::string markdown_line(const Row& row) { return fmt::format("| {} |\n", fmt::join(row, " | ")); }

// Aligns the first column to the left, all others to the right.
std::string aligned_line(const Row& row, const std::vector<std::size_t>& widths) {
  std::string text = fmt::format("{:<{}}", row.front(), widths.front());
  for (std::size_t c = 1; c < row.size(); ++c) text += fmt::format("  {:>{}}", row[c], widths[c]);
  return text + "\n";
}

}  // namespace

std::string csv_cell(double value) { return std::isnan(value) ? std::string() : number_text(value); }

std::string csv_line(const Row& row) {
  Row cells = row;
  for (std::string& cell : cells) cell = quoted_cell(cell);
  return fmt::format("{}\n", fmt::join(cells, ","));
}

Row csv_cells(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  Row cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_quote = line[i] == '"';
    if (quoted && is_quote && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (is_quote) {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

std::string table_text(const Row& head, const std::vector<Row>& rows, TableStyle style) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < head.size(); ++c) {
    widths.push_back(head[c].size());
    for (const Row& row : rows) widths[c] = std::max(widths[c], row.at(c).size());
  }
  const auto line = [&](const Row& row) {
    if (style == TableStyle::kCsv) return csv_line(row);
    return style == TableStyle::kMarkdown ? markdown_line(row) : aligned_line(row, widths);
  };
  std::string text = line(head);
  if (style == TableStyle::kMarkdown) {
    Row rule(head.size(), "---:");
    rule.front() = "---";
    text += markdown_line(rule);
  }
  for (const Row& row : rows) text += line(row);
  return text;
}

}  // namespace koboshi
