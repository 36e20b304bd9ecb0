#pragma once

#include <cstdint>
#include <stdexcept>

namespace koboshi::sim {

// The clock of a sensor: sampling instants at whole multiples of its period, whatever the physics step is.
class Sampler {
 public:
  explicit Sampler(std::uint64_t period_us) : period_us_(period_us), next_us_(period_us) {
    if (period_us == 0) throw std::invalid_argument("sampler: period must be at least one microsecond");
  }

  // The first instant is the first multiple of the period after `time_us`.
  void start(std::uint64_t time_us) { next_us_ = (time_us / period_us_ + 1) * period_us_; }
  bool due(std::uint64_t time_us) const { return next_us_ <= time_us; }
  // The next instant; the one after it follows.
  std::uint64_t take() {
    const std::uint64_t instant_us = next_us_;
    next_us_ += period_us_;
    return instant_us;
  }

 private:
  std::uint64_t period_us_;
  std::uint64_t next_us_;
};

}  // namespace koboshi::sim
