#pragma once

#include <algorithm>
#include <cstdint>

namespace koboshi::walk {

// Commanded velocity of the robot over the ground, in the axes of its trunk: x forward, y left, z up.
struct Velocity {
  std::int16_t forward_mm_per_s = 0;
  std::int16_t left_mm_per_s = 0;
  std::int16_t turn_mrad_per_s = 0;  // counter-clockwise

  friend bool operator==(const Velocity&, const Velocity&) = default;
};

// The largest velocities that the robot obeys, none of them negative. Neutral: it obeys none but zero.
struct VelocityLimits {
  std::int16_t forward_mm_per_s = 0;
  std::int16_t backward_mm_per_s = 0;
  std::int16_t lateral_mm_per_s = 0;  // to either side
  std::int16_t turn_mrad_per_s = 0;   // either way

  constexpr Velocity lowest() const {
    return {static_cast<std::int16_t>(-backward_mm_per_s), static_cast<std::int16_t>(-lateral_mm_per_s),
            static_cast<std::int16_t>(-turn_mrad_per_s)};
  }
  constexpr Velocity highest() const { return {forward_mm_per_s, lateral_mm_per_s, turn_mrad_per_s}; }

  friend bool operator==(const VelocityLimits&, const VelocityLimits&) = default;
};

constexpr Velocity clamped(const Velocity& velocity, const VelocityLimits& limits) {
  const Velocity low = limits.lowest();
  const Velocity high = limits.highest();
  return {std::clamp(velocity.forward_mm_per_s, low.forward_mm_per_s, high.forward_mm_per_s),
          std::clamp(velocity.left_mm_per_s, low.left_mm_per_s, high.left_mm_per_s),
          std::clamp(velocity.turn_mrad_per_s, low.turn_mrad_per_s, high.turn_mrad_per_s)};
}

}  // namespace koboshi::walk
