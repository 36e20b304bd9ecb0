#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/robot/model.h"

namespace koboshi::drive {

// What the controller and its drives exchange in each cycle, as it stands in the controller's object
// dictionary: by joint, in the drives' own words and units (CiA 402; positions in 2^-position_bits turns of
// the shaft).
struct DriveSignals {
  std::array<std::uint16_t, robot::kMaxJoints> controlword{};
  std::array<std::int32_t, robot::kMaxJoints> target_position{};
  std::array<std::uint16_t, robot::kMaxJoints> statusword{};
  std::array<std::int32_t, robot::kMaxJoints> position{};
  std::array<std::int16_t, robot::kMaxJoints> torque_permille{};
};

}  // namespace koboshi::drive
