#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sim_board/input/yaml_tree.h"

namespace koboshi::simulation {

// Of the firmware's gyro feedback: rad of correction for rad/s of the trunk.
struct GyroFeedbackGains {
  double ankle_pitch_s = 0.0;
  double ankle_roll_s = 0.0;
  double hip_roll_s = 0.0;
  double knee_s = 0.0;
};

struct UpperBodyAngle {
  std::string joint;  // named as in a motion: with its side, or without for both
  int line = 0;
  double angle_rad = 0.0;
};

// A walk in the terms of the paper's section 3, read from robots/*/gait.yaml; docs/reference/gait-format.md.
struct Gait {
  std::filesystem::path file;  // for error messages
  std::string robot;

  int points = 8;                // into which a cycle of two steps is divided
  double period_s = 0.5;         // of the cycle
  double step_length_m = 0.03;   // how far a foot lands ahead of the other
  double step_width_m = 0.064;   // between the middle lines of the soles
  double step_height_m = 0.02;   // of the swinging sole
  double swing_ease = 0.5;       // 1: the sole starts and lands without forward speed, 0: at constant speed
  double com_height_m = 0.17;    // above the ground
  double double_support = 0.2;   // share of a step in which the ZMP goes from foot to foot
  double trunk_pitch_rad = 0.0;  // forward
  double zmp_ahead_m = 0.0;      // of the sole's origin, below the ankle
  double zmp_inward_m = 0.0;     // from the sole's middle line
  double sag_compensation =
      0.0;              // share of the servos' sag under the robot's weight that targets make up for
  int start_steps = 2;  // that grow from standing to the whole length, and shrink back

  std::vector<UpperBodyAngle> upper_body;  // of joints besides the legs'; all others at zero
  GyroFeedbackGains feedback;
};

// Throws sim::InputError with the line of what is missing, unknown, doubled or out of range. Overrides are
// those of --set.
[[nodiscard]] Gait read_gait(const std::filesystem::path& file,
                             std::span<const sim::Override> overrides = {});

}  // namespace koboshi::simulation
