#pragma once

#include <cstdint>

namespace koboshi::behaviour {

// Commands of the operator. The values are those of object 0x2000, which RPDO 0 carries (CiA 301 counts it as
// the first, 0x1400).
enum class Command : std::uint8_t {
  kNone = 0,
  kEnable = 1,
  kLimp = 2,
  kPlay = 3,  // argument: number of the motion
  kStop = 4,  // ends the motion, the walk or the stream in an orderly way
  kEmergencyStop = 5,
  kReset = 6,
  kWalk = 7,       // at the commanded velocity, object 0x2110, until kStop
  kCalibrate = 8,  // measures the gyro's bias at rest and puts it into the parameters
  kGetUp = 9,      // stands up from wherever the robot lies, as after a fall
  kStream = 10,    // follows the joint targets of object 0x2161, until kStop or until they stop coming
};

}  // namespace koboshi::behaviour
