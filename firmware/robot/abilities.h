#pragma once

#include <cstdint>

#include "firmware/robot/model.h"

namespace koboshi::robot {

// An ability that a robot lacks if its body or its sensors do not support it. The value is the bit of
// object 0x2201.
enum class Ability : std::uint8_t {
  kZmp = 0,             // measures the ZMP
  kFootLoads = 1,       // measures the load of each foot; else only the contact is known
  kContactSensing = 2,  // senses the contact of each foot; else it is derived from the torques of the legs
  kEarlyTouchdown = 3,  // ends a step when the swing foot meets the ground early; else by time alone
  kWalking = 4,         // walks by command: legs of five or six joints
  kTurning = 5,         // turns while it walks: hips with yaw
  kArmSwing = 6,        // swings its arms while it walks: shoulders with pitch
};
inline constexpr std::size_t kAbilities = 7;

// Returns the abilities that the robot lacks; bit i: Ability i.
[[nodiscard]] std::uint16_t lost_abilities(const RobotModel& model);

}  // namespace koboshi::robot
