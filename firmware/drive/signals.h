#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/robot/model.h"

namespace koboshi::drive {

// The cyclic data of all drives, as in the controller's object dictionary: arrays by joint, in the words and
// units of the drives (CiA 402; positions in 2^-position_bits turn of the shaft).
struct DriveSignals {  // plain arrays, since the dictionary addresses their elements
  std::uint16_t controlword[robot::kMaxJoints] = {};
  std::int32_t target_position[robot::kMaxJoints] = {};
  std::uint16_t statusword[robot::kMaxJoints] = {};
  std::int32_t position[robot::kMaxJoints] = {};
  std::int16_t torque_permille[robot::kMaxJoints] = {};
};

}  // namespace koboshi::drive
