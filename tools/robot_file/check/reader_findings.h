#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/robot_file/check/finding.h"
#include "tools/robot_file/check/places.h"

namespace koboshi::tools {

// The reader's findings in a robot's file, R001 and R011 to R027.
struct ReaderFindings {
  std::vector<ModelFinding> findings{};
  // The robot of the repaired file; none if a fault has no repair that can be made without a choice.
  std::optional<sim_board::RobotDescription> robot{};
  std::optional<ModelPlaces> places{};  // none: the file is no XML of a robot
};

// Finds everything for which the reader would refuse the text. Makes the repairs in memory, so that other
// checks can go on.
[[nodiscard]] ReaderFindings find_reader_findings(const std::filesystem::path& file, const std::string& text);

}  // namespace koboshi::tools
