#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "firmware/canopen/cia402.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/drive/motion_profile.h"

// Reduces the motion that a controller asks for to the limits in a drive's objects. Positions in 2^-20
// turn.
namespace koboshi::sim_board {

// Positions within the software position limits.
struct PositionRange {
  double lowest_units = std::numeric_limits<std::int32_t>::min();
  double highest_units = std::numeric_limits<std::int32_t>::max();
};

// Limits of the targets of a cyclic mode.
struct CyclicLimits {
  double step_units = 0.0;  // from one target to the next; more is a jump, and no motion that goes on
  ProfileLimits motion;     // the most that the drive does
  ProfileLimits jump;       // how a jump is approached, until it is a step away
  PositionRange range = {};
};

// 0x607D while a client has written only one of two new limits, say: no position lies within.
inline bool limits_contradict(const DriveValues& values) {
  return values.position_limit[0] > values.position_limit[1];
}

// 0x607D; every position while they contradict each other.
inline PositionRange position_range(const DriveValues& values) {
  if (limits_contradict(values)) return {};
  return {.lowest_units = values.position_limit[0] * 1.0, .highest_units = values.position_limit[1] * 1.0};
}

// Clamps a target to the software position limits; `present` if they contradict each other.
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

// 0x6081, 0x6083 and 0x6084. Before they have been written, those of a slow joint may be 0.
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

// units/s^2: the demand stands within microseconds, and the position loop brakes with all that current limit
// and supply let it.
inline constexpr double kAtOnce = 1e12;

// The least deceleration, units/s^2, with which a speed ends within a time and at the end of the range.
inline double least_deceleration(double speed_units_per_s, double position_units, const PositionRange& range,
                                 double time_s = std::numeric_limits<double>::infinity()) {
  const double room_units =
      speed_units_per_s > 0.0 ? range.highest_units - position_units : position_units - range.lowest_units;
  if (room_units <= 0.0) return kAtOnce;
  return std::max(std::abs(speed_units_per_s) / time_s,
                  0.5 * speed_units_per_s * speed_units_per_s / room_units);
}

inline CyclicLimits cyclic_limits(const DriveValues& values) {
  return {.step_units = values.largest_cyclic_step * 1.0,
          .motion = highest_limits(values),
          .jump = profile_limits(values),
          .range = position_range(values)};
}

}  // namespace koboshi::sim_board
