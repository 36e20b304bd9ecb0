#pragma once

#include <cstdint>
#include <string_view>

#include "sim_board/random/random_stream.h"

namespace koboshi::sim {

// By how much a sampling instant misses its time: a whole number of microseconds, each of those within
// +-largest as likely as any other, independent of the last.
class Jitter {
 public:
  Jitter(std::uint64_t largest_us, std::uint64_t seed, std::string_view name);

  // Of the next instant.
  std::int64_t sample_us();
  std::uint64_t largest_us() const { return static_cast<std::uint64_t>(largest_us_); }

 private:
  std::int64_t largest_us_;
  RandomStream random_;
};

// The clock of a sensor: sampling instants at whole multiples of its period, whatever the physics step is,
// and each as far off as its jitter says.
class Sampler {
 public:
  struct Instant {
    std::uint64_t nominal_us = 0;
    std::uint64_t actual_us = 0;
  };

  // What leaves at least a microsecond between two instants.
  static std::uint64_t most_jitter_us(std::uint64_t period_us) { return (period_us - 1) / 2; }

  // Throws std::invalid_argument for a period of nothing and for jitter of half a period and more.
  Sampler(std::uint64_t period_us, const Jitter& jitter);

  // The first instant is nominally the first multiple of the period after `time_us`, and never before it.
  void start(std::uint64_t time_us);
  bool due(std::uint64_t time_us) const { return next_.actual_us <= time_us; }
  // The next instant; the one after it follows.
  Instant take();

 private:
  void schedule(std::uint64_t nominal_us);

  std::uint64_t period_us_;
  Jitter jitter_;
  Instant next_;
};

}  // namespace koboshi::sim
