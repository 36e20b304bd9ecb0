#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::tools {

// Fields of a line of a table, without blanks around them. A field in quotation marks may contain the
// separator, and two marks for one (RFC 4180); it ends on its line.
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line, char separator);

// Parses a number with a decimal point or, as spreadsheets of many countries write it, a decimal comma.
[[nodiscard]] std::optional<double> csv_number(std::string_view field);

// The line with the names of the columns, the first of which is a time.
struct CsvHeader {
  char separator = ',';
  std::vector<std::string> names;
  std::size_t line = 1;         // of the names
  std::size_t lines_above = 1;  // lines that no row has: up to the names, and comments below them
};

// Finds the header of a table of angles: the first line that is not empty, no comment (`#` or `//`), and not
// the line `sep=;` that spreadsheets write. A header in the last comment above the first row counts too
// (NumPy's savetxt). Returns nothing if the text is no such table.
[[nodiscard]] std::optional<CsvHeader> find_csv_header(std::string_view text);

// Whether the line, without blanks around it, has no row: it is empty or a comment.
[[nodiscard]] bool is_csv_comment(std::string_view line);

}  // namespace koboshi::tools
