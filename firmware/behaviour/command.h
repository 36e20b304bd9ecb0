#pragma once

#include <cstdint>

namespace koboshi::behaviour {

// What an operator may ask for. The values stand in RPDO 1 and in object 0x2000.
enum class Command : std::uint8_t {
  kNone = 0,
  kEnable = 1,
  kLimp = 2,
  kPlay = 3,  // argument: number of the motion
  kStop = 4,  // the motion or the walk comes to its end
  kEmergencyStop = 5,
  kReset = 6,
  kWalk = 7,       // with the velocity of object 0x2110, until kStop
  kCalibrate = 8,  // the gyro's bias at rest goes into the parameters
  kGetUp = 9,      // as after a fall
};

}  // namespace koboshi::behaviour
