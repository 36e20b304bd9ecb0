#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"
#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// The format with this name on the command line; nothing for another name.
[[nodiscard]] std::optional<MotionFormat> writable_format(const std::string& name);
[[nodiscard]] const std::vector<std::string>& writable_formats();

struct ExportedMotion {
  std::string bytes;
  std::vector<std::string> report;
  std::size_t frames = 0;
  double duration_s = 0.0;
};

// Writes a motion of the motion language in the format of another maker. The joints' names, numbers, signs
// and zeros are those of `map_file` (empty: none), then those of the robot's file. Throws InputError as
// flatten_motion(), and for a joint without a number in a format that numbers its joints.
[[nodiscard]] ExportedMotion export_motion(const simulation::MotionSource& source, MotionFormat format,
                                           const sim_board::RobotDescription& robot,
                                           const simulation::NamedModel& model,
                                           const std::filesystem::path& map_file = {});

}  // namespace koboshi::tools
