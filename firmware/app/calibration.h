#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/robot/model.h"

namespace koboshi::app {

// In what this robot differs from its model.
struct Calibration {
  // Added to each joint's commanded angle and taken from its measured one, 2^-16 turn: how far the joint is
  // short of what its encoder says.
  std::int16_t trims[robot::kMaxJoints] = {};
  // Roll, pitch and yaw of the inertial unit in the trunk, on top of the model's, 2^-16 turn: about the
  // trunk's fixed axes x, y and z in this order (REP-103).
  std::int16_t mounting[3] = {};
  // What the gyro shows at rest, 2^-24 turn/s in the trunk's axes, until a second of rest tells better.
  std::int32_t gyro_bias[3] = {};
};

// Gives a joint another trim: from then on its drive's zero, and with it its limits, targets and positions.
void change_trim(robot::Drive& drive, std::int16_t from, std::int16_t to);

// The unit's orientation in the trunk: the model's R_BI, turned by the mounting.
[[nodiscard]] robot::Rotation mounted(const robot::Rotation& R_BI, const std::int16_t (&mounting)[3]);

}  // namespace koboshi::app
