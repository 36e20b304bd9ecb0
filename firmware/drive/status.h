#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/drive/fault.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

// What the drives say of themselves at one instant; arrays by joint.
struct DriveStatus {
  bool configured = false;  // every drive has its configuration and was told to start
  bool booted = false;      // and each has answered a SYNC
  bool disabled = false;    // each is in the state switch on disabled
  bool enabled = false;     // each follows its targets, since the goal kEnabled was set
  bool limp = false;        // none makes torque
  JointFault fault;         // the first since the boot
  std::array<fixed::Angle, robot::kMaxJoints> angles{};  // where the joints are; meaningful once booted
  // Bit i: joint i's encoder stands outside the joint's limits by more than DriveGroup::kEncoderMargin.
  std::uint32_t beyond_limits = 0;
  std::array<std::uint32_t, robot::kMaxJoints> supply_mV{};  // as each told last
  std::optional<std::uint32_t> new_supply_mV;                // what one of them has told in this cycle
};

}  // namespace koboshi::drive
