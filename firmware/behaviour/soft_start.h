#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::behaviour {

// A slow ramp of all joints from one pose to another: all of them begin and arrive together.
class SoftStart {
 public:
  static constexpr std::int32_t kMinDuration_us = 500'000;

  // Both poses have one angle a joint. `rate`, in 2^-12 turn/s and positive: no joint turns faster.
  void begin(std::span<const fixed::Angle> from, std::span<const fixed::Angle> to, std::int16_t rate);
  // Lets time pass, and writes where the joints are to be then.
  void advance(std::int32_t elapsed_us, std::span<fixed::Angle> targets);
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
