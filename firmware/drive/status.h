#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/drive/fault.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

// The state of all drives at one instant; arrays by joint.
struct DriveStatus {
  bool configured = false;  // every drive has its configuration and was told to start
  bool booted = false;      // configured, and each has answered a SYNC
  bool enabled = false;     // each follows its targets, since the goal kEnabled was set
  bool limp = false;        // no drive makes torque
  JointFault fault;         // the first since the boot
  std::array<fixed::Angle, robot::kMaxJoints> angles{};  // where the joints are; meaningful once booted
  std::optional<std::uint32_t> new_supply_mV;            // of one drive, if it was read in this cycle
  std::uint32_t lowest_supply_mV = 0;                    // of the last readings of all drives
};

// The conditions for enabling the drives, at one instant; needed only when that is requested.
struct EnableConditions {
  bool disabled = false;  // each drive is in the state switch on disabled (CiA 402-2)
  // Bit i: joint i's encoder reads beyond the joint's limits by more than DriveGroup::kEncoderMargin.
  std::uint32_t beyond_limits = 0;
  std::array<std::uint32_t, robot::kMaxJoints> supply_mV{};  // of each drive, as last read
};

}  // namespace koboshi::drive
