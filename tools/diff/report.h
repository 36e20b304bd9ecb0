#pragma once

#include <filesystem>
#include <string>

namespace koboshi::tools {

struct RunComparison {
  bool same = false;
  std::string report;  // for people; ends with a newline
};

// Compares trace.csv and can.log of two runs' folders, and says in what they differ first: the tick with its
// variables, the frame on the bus, and the frames around that. Throws sim::InputError when a folder holds no
// run.
RunComparison compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace koboshi::tools
