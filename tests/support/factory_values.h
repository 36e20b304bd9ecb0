#pragma once

#include "firmware/app/dictionary.h"
#include "tests/support/tuned_gait.h"

namespace koboshi::test {

inline constexpr walk::VelocityLimits kTestVelocityLimits{
    .forward_mm_per_s = 330, .backward_mm_per_s = 260, .lateral_mm_per_s = 130, .turn_mrad_per_s = 1600};
inline constexpr behaviour::PowerParameters kTestPower{
    .supply_min_mV = 6000, .supply_max_mV = 9000, .ramp_rate = 683, .supply_low_mV = 6300};
inline constexpr behaviour::FallLimits kTestFallLimits{
    .front = 4'733, .back = 4'733, .side = 5'097, .lead_ms = 135, .min_lean = 1'820, .cycles = 2};
inline constexpr behaviour::RecoveryParameters kTestRecovery{.fall = kTestFallLimits,
                                                             .getting_up = {.attempts = 3, .slower = 20}};

// Returns the factory parameters of the test robot.
inline app::ControllerValues factory_values() {
  app::ControllerValues values;
  values.parameters = kTestPower;
  values.feedback.walking = {
      .rate = {.ankle_pitch = 203, .ankle_roll = 252, .hip_roll = 82, .knee = 47, .hip_pitch = 102},
      .lean = {.ankle_pitch = 0, .ankle_roll = 287, .hip_roll = 922, .knee = 0, .hip_pitch = 0}};
  values.velocity_limits = kTestVelocityLimits;
  values.walk = tuned_gait();
  values.recovery = kTestRecovery;
  return values;
}

}  // namespace koboshi::test
