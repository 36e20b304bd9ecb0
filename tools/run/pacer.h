#pragma once

#include <chrono>
#include <cstdint>

namespace koboshi::tools {

// Holds simulated time back to the clock on the wall.
class Pacer {
 public:
  // Later than this is an overrun.
  static constexpr std::uint64_t kTolerance_us = 2'000;

  // `speed` is how many simulated seconds one of the wall has.
  explicit Pacer(std::uint64_t now_us, double speed = 1.0)
      : start_us_(now_us), speed_(speed), start_(Clock::now()) {}

  // Returns when the wall has reached this simulated time; at once when it is later already. Time that was
  // lost is made up for as fast as the simulation can.
  void wait_for(std::uint64_t now_us);

  std::uint64_t overruns() const { return overruns_; }
  std::uint64_t largest_delay_us() const { return largest_delay_us_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::uint64_t start_us_;
  double speed_;
  Clock::time_point start_;
  std::uint64_t overruns_ = 0;
  std::uint64_t largest_delay_us_ = 0;
};

}  // namespace koboshi::tools
