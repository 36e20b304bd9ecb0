#pragma once

#include <string>

#include "tools/manual/command_table.h"

namespace koboshi::tools {

// Texts of a manual page that are not in the table of commands.
struct PageContext {
  std::string version;  // of the program
  std::string date;     // 2026-11-26; empty: none
};

// Returns the manual page (man(7), section 1) of a command of the program, from the texts of its `--help`.
// The indented lines of a footer become examples and tables, the lines after "Example:" or "Examples:" their
// section.
[[nodiscard]] std::string manual_page(const Command& command, const PageContext& context);

}  // namespace koboshi::tools
