#pragma once

#include <filesystem>
#include <string>

namespace koboshi::tools {

struct RunComparison {
  bool same = false;
  std::string report;  // for people; ends with a newline
};

// Compares trace.csv and can.log in the folders of two runs. Reports the first difference: the tick with its
// variables, and the frame on the bus with the frames around it. Throws InputError for a folder without
// a run.
RunComparison compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace koboshi::tools
