#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>
#include <utility>

#include "tools/run/interrupt.h"

namespace koboshi::tools {

// The wall clock; tests replace it.
struct WallClock {
  using Time = std::chrono::steady_clock::time_point;

  std::function<Time()> now = std::chrono::steady_clock::now;
  std::function<void(Time)> sleep_until = [](Time due) { std::this_thread::sleep_until(due); };
};

// The wall clock, whose waits a signal ends. The interrupt must outlive it.
inline WallClock interruptible(Interrupt& interrupt) {
  WallClock wall;
  wall.sleep_until = [&interrupt](WallClock::Time due) { interrupt.sleep_until(due); };
  return wall;
}

// Keeps simulated time from running ahead of the wall clock.
class Pacer {
 public:
  // A longer delay is an overrun.
  static constexpr std::uint64_t kTolerance_us = 2'000;

  // `speed` is in simulated seconds per second of the wall clock.
  explicit Pacer(std::uint64_t now_us, double speed = 1.0, WallClock wall = {})
      : start_us_(now_us), speed_(speed), wall_(std::move(wall)), start_(wall_.now()) {}

  // Returns when the wall clock has reached this simulated time, and at once if it is later: the simulation
  // then catches up as fast as it can.
  void wait_for(std::uint64_t now_us);

  // Delay behind the wall clock at the last wait.
  std::uint64_t delay_us() const { return delay_us_; }
  std::uint64_t overruns() const { return overruns_; }
  std::uint64_t largest_delay_us() const { return largest_delay_us_; }

 private:
  std::uint64_t start_us_;
  double speed_;
  WallClock wall_;
  WallClock::Time start_;
  std::uint64_t delay_us_ = 0;
  std::uint64_t overruns_ = 0;
  std::uint64_t largest_delay_us_ = 0;
};

}  // namespace koboshi::tools
