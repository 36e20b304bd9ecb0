#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace koboshi::tools {

// A value of the source that the import replaces.
struct ImportRepair {
  std::string key{};      // "trunk.inertia": an entry of `repairs` in import.yaml
  std::string found{};    // with its unit
  std::string taken{};    // with its unit
  std::string because{};  // a phrase
  bool is_kept = false;   // import.yaml keeps the value that was found
};

// The steps of an import, in the order of their execution. Each line is a whole phrase.
struct ImportReport {
  std::vector<std::string> ignored{};     // parts of the source without a counterpart
  std::vector<std::string> normalised{};  // poses that changed, each with its miss
  std::vector<ImportRepair> repairs{};
  std::vector<std::string> warnings{};
};

// Returns a place for a line of a report: "(1.0, -2.5, 0.0) mm".
[[nodiscard]] std::string millimetres(const Eigen::Vector3d& p_m);

}  // namespace koboshi::tools
