#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/yaml/yaml_reader.h"

namespace koboshi::simulation {

// Gains of the firmware's gyro feedback, in rad of correction per rad/s of the trunk's rate.
struct GyroFeedbackGains {
  double ankle_pitch_s = 0.0;
  double ankle_roll_s = 0.0;
  double hip_roll_s = 0.0;
  double knee_s = 0.0;
};

struct UpperBodyAngle {
  std::string joint;  // named as in a motion: with its side, or without for both sides
  int line = 0;
  double angle_rad = 0.0;
};

// Parameters of a walk in the terms of the paper's section 3, read from robots/*/gait.yaml
// (docs/reference/gait-format.md).
struct Gait {
  std::filesystem::path file;  // for error messages
  std::string robot;

  int points = 8;                 // poses per cycle of two steps
  double period_s = 0.5;          // duration of a cycle
  double step_length_m = 0.03;    // forward distance between the feet at touchdown
  double step_width_m = 0.064;    // between the centre lines of the soles
  double step_height_m = 0.02;    // clearance of the swing sole
  double swing_profile = 0.5;     // 1: zero forward speed at lift-off and touchdown, 0: constant speed
  double com_height_m = 0.17;     // above the ground
  double double_support = 0.2;    // share of a step in which the ZMP shifts between the feet
  double trunk_pitch_rad = 0.0;   // positive forward
  double zmp_forward_m = 0.0;     // forward offset from the sole's origin below the ankle
  double zmp_inward_m = 0.0;      // offset towards the other foot from the sole's centre line
  double sag_compensation = 0.0;  // share of the servos' gravity sag that the targets compensate
  int start_steps = 2;  // steps of increasing length at the start, and of decreasing length at the stop

  std::vector<UpperBodyAngle> upper_body;  // joints other than the legs'; the rest stay at zero
  GyroFeedbackGains feedback;
};

// Reads a gait file; `overrides` are those of --set. Throws InputError with the line of a missing,
// unknown, duplicate or out-of-range key.
[[nodiscard]] Gait read_gait(const std::filesystem::path& file, std::span<const Override> overrides = {});
// Reads the contents of such a file. Throws the same.
[[nodiscard]] Gait read_gait(const YamlFile& yaml);

}  // namespace koboshi::simulation
