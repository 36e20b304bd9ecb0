#pragma once

#include <cstdint>

#include "firmware/behaviour/fall_watch.h"
#include "firmware/walk/gait.h"
#include "firmware/walk/velocity.h"

namespace koboshi::behaviour {

// Supply and soft start, object 0x2100.
struct PowerParameters {
  std::uint16_t supply_min_mV = 6000;  // with less, or more than the next, the robot refuses to be enabled
  std::uint16_t supply_max_mV = 9000;
  std::int16_t ramp_rate = 683;        // of the soft start, 2^-12 turn/s: 60 degrees a second
  std::uint16_t supply_low_mV = 6300;  // what the battery should not fall below
};

struct GettingUp {
  std::uint8_t attempts = 3;  // of which each is slower than the last; 0: who falls stays down
  std::uint8_t slower = 20;   // percent of the first one's pace, which each further attempt has less
};

struct RecoveryParameters {
  FallLimits fall;
  GettingUp getting_up;
};

// What the behaviour reads of the object dictionary; may change between two calls of it.
struct Parameters {
  const PowerParameters& power;
  const walk::VelocityLimits& velocity_limits;
  const walk::WalkParameters& walk;
  const RecoveryParameters& recovery;
};

}  // namespace koboshi::behaviour
