#pragma once

#include <cstdint>
#include <optional>

#include "sim_board/servo/motion_profile.h"

namespace koboshi::sim {

// The position that a drive asks of its servo between two targets of the bus, in units of the bus (2^-20
// turn). Cyclic synchronous position mode: each new target is approached linearly over one interpolation
// period (CiA 402, 0x60C2), starting where the demand stands. After `stop` the demand's speed falls with a
// constant deceleration (0x6085). Profile position mode: `move` follows a trapezoidal profile from whatever
// the demand does to rest at its target.
class PositionDemand {
 public:
  // Stands at `position`.
  void hold(std::int32_t position);
  void approach(std::int32_t target, std::uint64_t now_us, std::uint32_t period_us);
  void stop(std::uint64_t now_us, double deceleration_units_per_s2);
  void move(std::int32_t target, std::uint64_t now_us, const ProfileLimits& limits);

  // Position at `now_us`, never before the last call's time.
  std::int32_t at(std::uint64_t now_us) const;
  double speed_units_per_s(std::uint64_t now_us) const;
  bool stands(std::uint64_t now_us) const { return now_us >= end_us_; }
  // Stands, and not only because the next target of a motion has yet to come.
  bool at_rest(std::uint64_t now_us) const { return stands(now_us) && end_speed_ == 0.0; }

 private:
  double position_at(std::uint64_t now_us) const;

  double start_ = 0.0;         // position at start_us_
  double speed_ = 0.0;         // at start_us_
  double deceleration_ = 0.0;  // signed: speed(t) = speed_ - deceleration_ * t
  std::uint64_t start_us_ = 0;
  std::uint64_t end_us_ = 0;  // from here on the demand stands at end_
  double end_ = 0.0;
  double end_speed_ = 0.0;  // with which it arrives there
  std::optional<MotionProfile> profile_;
};

}  // namespace koboshi::sim
