#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::behaviour {

// A slow ramp of all joints from one pose to another, linear in time. All joints start and arrive together.
class SoftStart {
 public:
  // Of a ramp that hardly moves. Set by hand; not tuned.
  static constexpr std::int32_t kMinDuration_us = 500'000;

  // Starts a ramp. `from` and `to` have one angle for each joint, at most robot::kMaxJoints. `rate`, positive
  // and in 2^-12 turn/s, is the rate of the joint with the longest travel, unless kMinDuration_us is longer.
  void begin(std::span<const fixed::Angle> from, std::span<const fixed::Angle> to, std::int16_t rate);
  // Advances the ramp by `elapsed_us` and writes the targets, one for each joint; beyond its end, `to`.
  void advance(std::int32_t elapsed_us, std::span<fixed::Angle> targets);
  // Returns whether the ramp has ended.
  bool arrived() const { return elapsed_us_ >= duration_us_; }

 private:
  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  std::size_t joints_ = 0;
  Angles from_{};
  Angles to_{};
  std::int32_t elapsed_us_ = 0;
  std::int32_t duration_us_ = 0;
};

}  // namespace koboshi::behaviour
