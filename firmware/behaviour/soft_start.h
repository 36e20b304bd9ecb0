#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/behaviour/motion_source.h"
#include "firmware/robot/model.h"

namespace koboshi::behaviour {

// A slow ramp of all joints from one pose to another, linear in time. All joints start and arrive together.
class SoftStart final : public MotionSource {
 public:
  // Duration of a ramp that hardly moves. Set by hand; not tuned.
  static constexpr std::int32_t kMinDuration_us = 500'000;

  // Starts a ramp. `from` and `to` have one angle for each joint, at most robot::kMaxJoints. `rate`, positive
  // and in 2^-12 turn/s, is the rate of the joint with the longest travel, unless kMinDuration_us is longer.
  void begin(std::span<const fixed::Angle> from, std::span<const fixed::Angle> to, std::int16_t rate);
  // Beyond the end of the ramp the targets are `to`.
  void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
               std::span<fixed::Angle> targets) override;
  // The ramp goes to its end.
  void stop() override {}
  void abort() override { elapsed_us_ = duration_us_; }
  [[nodiscard]] bool running() const override { return elapsed_us_ < duration_us_; }

 private:
  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  std::size_t joints_ = 0;
  Angles from_{};
  Angles to_{};
  std::int32_t elapsed_us_ = 0;
  std::int32_t duration_us_ = 0;
};

}  // namespace koboshi::behaviour
