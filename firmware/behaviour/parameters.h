#pragma once

#include <cstdint>

#include "firmware/behaviour/fall_detector.h"
#include "firmware/walk/gait.h"
#include "firmware/walk/velocity.h"

namespace koboshi::behaviour {

// Supply and soft start, object 0x2100.
struct PowerParameters {
  // Below it, or above supply_max_mV, the robot refuses to be enabled. The neutral values accept any supply,
  // because the firmware does not know the battery.
  std::uint16_t supply_min_mV = 0;
  std::uint16_t supply_max_mV = 0xFFFF;
  // Speed of the soft start, 2^-12 turn/s. By hand, 2026-11-21: 60 degrees a second, at which half a turn
  // takes 3 s.
  std::int16_t ramp_rate = 683;
  // An open-circuit voltage below it for two seconds counts as low (SupplyGuard): the robot sits down.
  std::uint16_t supply_low_mV = 0;
  // Sag of the supply while one drive stalls at its rated voltage; 0: the guard judges the voltage under
  // load.
  std::uint16_t stalled_drive_sag_mV = 0;
  // Speed of a drive without load at its rated voltage, 2^-12 turn/s; 0: the estimate leaves out the power of
  // turning motors.
  std::int16_t no_load_speed = 0;
};

struct GettingUp {
  std::uint8_t attempts = 0;  // each is slower than the last; 0: a robot that fell stays down
  std::uint8_t slower = 0;    // slowdown per further attempt, in percent of the first one's pace
};

struct RecoveryParameters {
  FallLimits fall;
  // Limit of the lean that a motion may declare, in each direction, 2^-16 turn; 0: none counts.
  std::int16_t max_declared_lean = 0;
  GettingUp getting_up;
};

// The parameters of the behaviour, which live in the object dictionary and may change between two cycles.
struct Parameters {
  const PowerParameters& power;
  const walk::VelocityLimits& velocity_limits;
  const walk::WalkParameters& walk;
  const RecoveryParameters& recovery;
};

}  // namespace koboshi::behaviour
