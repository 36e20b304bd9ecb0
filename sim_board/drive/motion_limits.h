#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/canopen/cia402.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/drive/motion_profile.h"

// What the limits in a drive's objects leave of the motion that a controller asks for. Positions in 2^-20
// turn.
namespace koboshi::sim {

// Of the targets of a cyclic mode.
struct CyclicLimits {
  double step_units = 0.0;  // from one target to the next; more is a jump, and no motion that goes on
  ProfileLimits motion;     // the most that the drive does
  ProfileLimits jump;       // how a jump is approached, until it is a step away
};

// 0x607D while a client has written only one of two new limits, say: no position lies within.
inline bool limits_contradict(const DriveValues& values) {
  return values.position_limit[0] > values.position_limit[1];
}

// What the software position limits leave of a target; `present` where they contradict each other.
inline std::int32_t within_limits(const DriveValues& values, std::int64_t target, std::int32_t present) {
  if (limits_contradict(values)) return present;
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(target, values.position_limit[0], values.position_limit[1]));
}

// 0x6080 and 0x60C5, which bounds a profile's deceleration too, as there is no 0x60C6.
inline ProfileLimits highest_limits(const DriveValues& values) {
  constexpr double kUnits_per_s_of_rpm = (1 << canopen::cia402::kPositionUnitBits) / 60.0;
  return {.velocity_units_per_s = values.max_motor_speed_rpm * kUnits_per_s_of_rpm,
          .acceleration_units_per_s2 = values.max_acceleration * 1.0,
          .deceleration_units_per_s2 = values.max_acceleration * 1.0};
}

// 0x6081, 0x6083 and 0x6084, as they are written. An RPDO may bring a 0, which is the slowest move there is.
inline ProfileLimits asked_limits(const DriveValues& values) {
  return {.velocity_units_per_s = std::max(values.profile_velocity, 1u) * 1.0,
          .acceleration_units_per_s2 = std::max(values.profile_acceleration, 1u) * 1.0,
          .deceleration_units_per_s2 = std::max(values.profile_deceleration, 1u) * 1.0};
}

// The same within the highest.
inline ProfileLimits profile_limits(const DriveValues& values) {
  const ProfileLimits asked = asked_limits(values);
  const ProfileLimits highest = highest_limits(values);
  return {
      .velocity_units_per_s = std::min(asked.velocity_units_per_s, highest.velocity_units_per_s),
      .acceleration_units_per_s2 =
          std::min(asked.acceleration_units_per_s2, highest.acceleration_units_per_s2),
      .deceleration_units_per_s2 =
          std::min(asked.deceleration_units_per_s2, highest.deceleration_units_per_s2),
  };
}

inline CyclicLimits cyclic_limits(const DriveValues& values) {
  return {.step_units = values.largest_cyclic_step * 1.0,
          .motion = highest_limits(values),
          .jump = profile_limits(values)};
}

}  // namespace koboshi::sim
