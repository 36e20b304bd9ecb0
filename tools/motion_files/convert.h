#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "simulation/model/robot_model.h"
#include "tools/motion_files/format/foreign_motion.h"
#include "tools/motion_files/joint_map.h"

namespace koboshi::tools {

struct ConversionOptions {
  // Stretches moves to what the servos can do, 0.9 of their speeds without load.
  bool retime = false;
  // The largest correction of an angle beyond its joint's limit, in rad; empty: any.
  std::optional<double> largest_clamp_rad{};
};

// A motion file in the motion language, and what was changed on the way, one sentence each.
struct ConvertedMotion {
  std::string text;
  std::vector<std::string> report;
  std::size_t frames = 0;     // of the file, in all sections
  std::size_t left_out = 0;   // of these, which straight moves between their neighbours reproduce
  std::size_t clamped = 0;    // angles
  std::size_t too_fast = 0;   // moves that the servos cannot do in their time
  std::size_t stretched = 0;  // of these, which were given more time
  double duration_s = 0.0;    // with all repetitions
  double original_s = 0.0;    // the same by the times of the file
};

// Converts a motion for a robot. `file` is named in messages and in the text. Times are kept to the
// microsecond, angles to 0.001 degrees. The first move has at least 1 s, because nobody knows where it
// begins. Throws InputError for an angle further beyond its limit than permitted, and for a motion that is
// too long for the motion language.
[[nodiscard]] ConvertedMotion convert_motion(const std::filesystem::path& file, const ForeignMotion& motion,
                                             const JointMap& map, const simulation::NamedModel& robot,
                                             const ConversionOptions& options = {});

}  // namespace koboshi::tools
