#pragma once

#include <string>
#include <vector>

namespace koboshi::tools {

// A file of docs/reference that is generated from the table of a robot file's keys (sim_board/description).
struct RobotReferenceFile {
  std::string name;
  std::string text;
};

// robot-file.md, robot.xsd and robot-koboshi.xsd, which robot.xsd imports.
[[nodiscard]] std::vector<RobotReferenceFile> robot_reference_files();

// The page: all keys with unit, values, default, meaning and source.
[[nodiscard]] std::string robot_page_text();
// XML Schema 1.0 of a robot's file: SDF's elements, which have no name space.
[[nodiscard]] std::string robot_xsd_text();
// XML Schema 1.0 of the koboshi: elements, and of libraries of servo types.
[[nodiscard]] std::string koboshi_xsd_text();

}  // namespace koboshi::tools
