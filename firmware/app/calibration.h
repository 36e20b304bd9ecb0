#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/robot/model.h"

namespace koboshi::app {

// The differences of this robot from its model, objects 0x2120 to 0x2122.
struct Calibration {
  // Added to each joint's commanded angle and subtracted from its measured one, 2^-16 turn: the joint's angle
  // at which its encoder reads zero, negated.
  std::int16_t trims[robot::kMaxJoints] = {};
  // Roll, pitch and yaw of the inertial unit in the trunk, in addition to the model's, 2^-16 turn: about the
  // trunk's fixed axes x, y and z in this order (REP-103).
  std::int16_t mounting[3] = {};
  // The gyro's rates at rest, 2^-24 turn/s in the trunk's axes: used until the first second of rest gives a
  // measured bias.
  std::int32_t gyro_bias[3] = {};
};

// Replaces the trim `from` of a joint by `to`, 2^-16 turn each: shifts the zero of its drive, and thereby
// limits, targets and positions.
void change_trim(robot::Drive& drive, std::int16_t from, std::int16_t to);

// The inertial unit's orientation in the trunk: the model's R_BI, rotated by Calibration::mounting.
[[nodiscard]] robot::Rotation mounted(const robot::Rotation& R_BI, const std::int16_t (&mounting)[3]);

}  // namespace koboshi::app
