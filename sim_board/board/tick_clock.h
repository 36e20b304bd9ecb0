#pragma once

#include <cstdint>

#include "sim_board/random/random_stream.h"

namespace koboshi::sim_board {

// The timer of the controller's tick. Each tick is late by a random time, uniform from 0 to its jitter, as
// under an operating system that serves other tasks; the delays do not add up.
class TickClock {
 public:
  // `period_us` is a multiple of `service_us`, and the jitter is less than the period.
  TickClock(std::uint64_t period_us, std::uint64_t service_us, std::uint64_t jitter_us, std::uint64_t seed)
      : period_us_(period_us),
        service_us_(service_us),
        jitter_us_(jitter_us),
        random_(seed, "tick jitter of the controller") {}

  // Called once in each service period, at its beginning. Returns whether a tick begins in it.
  bool due(std::uint64_t now_us) {
    if (now_us % period_us_ == 0) {
      const std::uint64_t delay_us = draw_us();
      due_us_ = now_us + delay_us / service_us_ * service_us_;
      late_us_ = delay_us % service_us_;
    }
    return now_us == due_us_;
  }
  // The beginning of the last tick, from that of its service period.
  std::uint64_t late_us() const { return late_us_; }

 private:
  std::uint64_t draw_us() {
    if (jitter_us_ == 0) return 0;
    return static_cast<std::uint64_t>(random_.uniform() * static_cast<double>(jitter_us_ + 1));
  }

  std::uint64_t period_us_;
  std::uint64_t service_us_;
  std::uint64_t jitter_us_;
  RandomStream random_;
  std::uint64_t due_us_ = 0;
  std::uint64_t late_us_ = 0;
};

}  // namespace koboshi::sim_board
