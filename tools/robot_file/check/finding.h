#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "simulation/motion_language/parse/diagnostic.h"

namespace koboshi::tools {

// A change of a robot's file: a value, or an element or attribute that goes.
struct ModelEdit {
  std::vector<std::size_t> place{};    // numbers of the child elements from the root to the element
  std::string attribute{};             // empty: the element itself
  std::optional<std::string> value{};  // the new text or attribute; none: remove it
};

// A finding about a robot file; docs/reference/model-check.md lists the codes.
struct ModelFinding {
  std::string code{};  // "R003"
  simulation::Severity severity = simulation::Severity::kWarning;
  std::filesystem::path file{};  // empty: the robot's own
  int line = 0;                  // of the file; 0: the file as a whole
  std::string found{};
  std::string expected{};
  std::string repair{};  // a whole sentence, empty if there is none

  // Where it is: the link, joint or servo type, the key of sim_board::find_robot_key() and the element's
  // numbers from the root. Empty for the file as a whole.
  std::string element{};  // "left_knee"
  std::string key{};      // "joint/axis/xyz"
  std::vector<std::size_t> place{};
  std::vector<ModelEdit> edits{};  // that make the repair; empty if people must choose
};

}  // namespace koboshi::tools
