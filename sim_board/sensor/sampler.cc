#include "sim_board/sensor/sampler.h"

#include <algorithm>
#include <stdexcept>

namespace koboshi::sim_board {

Jitter::Jitter(std::uint64_t largest_us, std::uint64_t seed, std::string_view name)
    : largest_us_(static_cast<std::int64_t>(largest_us)), random_(seed, name) {}

std::int64_t Jitter::sample_us() {
  if (largest_us_ == 0) return 0;
  return static_cast<std::int64_t>(random_.uniform() * static_cast<double>(2 * largest_us_ + 1)) -
         largest_us_;
}

Sampler::Sampler(std::uint64_t period_us, const Jitter& jitter) : period_us_(period_us), jitter_(jitter) {
  if (period_us == 0) throw std::invalid_argument("sampler: period must be at least one microsecond");
  if (jitter.largest_us() > max_jitter_us(period_us)) {
    throw std::invalid_argument("sampler: jitter must be less than half the period");
  }
  start(0);
}

void Sampler::start(std::uint64_t time_us) {
  schedule((time_us / period_us_ + 1) * period_us_);
  next_.actual_us = std::max(next_.actual_us, time_us);
}

Sampler::Instant Sampler::take() {
  const Instant instant = next_;
  schedule(instant.nominal_us + period_us_);
  return instant;
}

void Sampler::schedule(std::uint64_t nominal_us) {
  next_ = {nominal_us, nominal_us + static_cast<std::uint64_t>(jitter_.sample_us())};
}

}  // namespace koboshi::sim_board
