#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace koboshi::tools {

// Reads the columns of these names from a CSV file whose first row has names, such as the trace.csv of a run.
// Returns one vector per row, in the order of the names. Throws InputError for a missing column, a cell that
// is no number, and a file without rows.
[[nodiscard]] std::vector<std::vector<double>> read_recorded_columns(const std::filesystem::path& file,
                                                                     const std::vector<std::string>& names);

}  // namespace koboshi::tools
