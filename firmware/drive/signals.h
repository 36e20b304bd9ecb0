#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/robot/model.h"

namespace koboshi::drive {

// What the controller and its drives exchange in each cycle, as it stands in the controller's object
// dictionary: by joint, in the drives' own words and units (CiA 402; positions in 2^-position_bits turns of
// the shaft).
struct DriveSignals {  // plain arrays: the dictionary addresses their elements
  std::uint16_t controlword[robot::kMaxJoints] = {};
  std::int32_t target_position[robot::kMaxJoints] = {};
  std::uint16_t statusword[robot::kMaxJoints] = {};
  std::int32_t position[robot::kMaxJoints] = {};
  std::int16_t torque_permille[robot::kMaxJoints] = {};
};

}  // namespace koboshi::drive
