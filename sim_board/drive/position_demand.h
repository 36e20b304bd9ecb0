#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "sim_board/drive/motion_limits.h"
#include "sim_board/drive/motion_profile.h"

namespace koboshi::sim_board {

// The position that a drive asks of its servo between two targets of the bus, in units of the bus (2^-20
// turn). Cyclic synchronous position mode: each new target is approached linearly over one interpolation
// period (CiA 402, 0x60C2), starting where the demand stands, as long as that keeps the limits; else on a
// trapezoidal profile. After `stop` the demand's speed falls with a constant deceleration (0x6084 or 0x6085).
// Profile position mode: `move` follows a trapezoidal profile from whatever the demand does to rest at its
// target.
//
// No ramp leaves the range of positions: one that is too flat for that is steepened.
class PositionDemand {
 public:
  // The longest ramp of a stop; a flatter one is steepened. With the time that the drive then holds
  // (Drive::kStandTime_us) and the lag of the shaft, a stop ends within 1 s. Set by hand (2026-11-25).
  static constexpr std::uint64_t kMaxStopDuration_us = 800'000;

  // Stands at `position`.
  void hold(std::int32_t position);
  void approach(std::int32_t target, std::uint64_t now_us, std::uint32_t period_us);
  // The next target is the first of a stream, and may have nothing to do with where the demand is: a way that
  // the jump's velocity does not cover in a period counts as a jump.
  void await_stream() { joins_ = true; }
  // The next of a stream of targets. True when it is approached over the period; false when its distance, the
  // speed over the period, or the speed gained since the last period is beyond the limits, or the speed could
  // not become the stream's in the next one. Then the demand goes to rest there on a profile, and stays
  // behind a stream that moves on by what it takes to brake. Where a stream ends, the demand ends, at
  // whatever speed: it runs past no target.
  bool follow(std::int32_t target, std::uint64_t now_us, std::uint32_t period_us, const CyclicLimits& limits);
  // Ends within kMaxStopDuration_us of the first of several stops in a row. The ramp begins at the demand's
  // speed, or at the highest one that the shaft can have.
  void stop(std::uint64_t now_us, double deceleration_units_per_s2, const PositionRange& range,
            double highest_units_per_s = std::numeric_limits<double>::infinity());
  void move(std::int32_t target, std::uint64_t now_us, const ProfileLimits& limits,
            const PositionRange& range);
  // Continues at this position and speed until the `stop` that must follow.
  void continue_from(double position_units, double speed_units_per_s, std::uint64_t now_us);

  // Position at `now_us`, never before the last call's time.
  std::int32_t at(std::uint64_t now_us) const;
  double speed_units_per_s(std::uint64_t now_us) const;
  bool stands(std::uint64_t now_us) const { return now_us >= end_us_; }
  // Is under way on a ramp that has been steepened.
  bool steepened(std::uint64_t now_us) const { return steepened_ && !stands(now_us); }
  // Stands, and not only because the next target of a stream has yet to come: for that it has a period.
  bool at_rest(std::uint64_t now_us) const { return stands(now_us) && stream_speed(now_us) == 0.0; }

 private:
  double position_at(std::uint64_t now_us) const;
  // The demand's speed, or with which it has come to the last target if the next one may still be in time.
  double stream_speed(std::uint64_t now_us) const;

  double start_ = 0.0;         // position at start_us_
  double speed_ = 0.0;         // at start_us_
  double deceleration_ = 0.0;  // signed: speed(t) = speed_ - deceleration_ * t
  std::uint64_t start_us_ = 0;
  std::uint64_t end_us_ = 0;  // from here on the demand stands at end_
  double end_ = 0.0;
  double end_speed_ = 0.0;                   // with which it arrives there
  std::uint32_t wait_us_ = 0;                // how long a stream of targets may pause there
  double target_ = 0.0;                      // of the stream, the last
  bool joins_ = true;                        // a stream, and has not followed it yet
  bool jumps_ = false;                       // is on its way to where the stream has jumped
  bool steepened_ = false;                   // the ramp or the profile followed
  std::optional<std::uint64_t> stop_by_us_;  // of a stop in progress
  std::optional<MotionProfile> profile_;
};

}  // namespace koboshi::sim_board
