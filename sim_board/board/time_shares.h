#pragma once

#include <chrono>
#include <cstdint>

#include "hal/port/period.h"

namespace koboshi::sim_board {

// Wall time of each part of the board in seconds, estimated from samples. It depends on the machine and has
// no effect on a run.
struct TimeShares {
  double bus_s = 0.0;  // includes the drives' processing of frames
  double drives_s = 0.0;
  double firmware_s = 0.0;
  double physics_s = 0.0;
  double sensors_s = 0.0;
};

// Adds the wall time of its scope to a share. The wall time is sampled in one of kTimedOf milliseconds and
// counted for all of them: reading the clock is expensive, in a virtual machine more so than the measured
// code.
class Stopwatch {
 public:
  Stopwatch(double& share_s, std::uint64_t now_us)
      : share_s_(now_us / hal::kServicePeriod_us % kTimedOf == 0 ? &share_s : nullptr),
        start_(share_s_ == nullptr ? Clock::time_point() : Clock::now()) {}
  ~Stopwatch() {
    if (share_s_ == nullptr) return;
    *share_s_ += static_cast<double>(kTimedOf) * std::chrono::duration<double>(Clock::now() - start_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::uint64_t kTimedOf = 7;  // coprime to the ten milliseconds of a tick

  double* share_s_;
  Clock::time_point start_;
};

}  // namespace koboshi::sim_board
