#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim_board/servo/encoder.h"

namespace koboshi::sim_board {

// Between the bus and a position loop, in periods of that loop.

// Takes a new target once in so many calls, and holds it between.
class CommandPeriod {
 public:
  explicit CommandPeriod(int period) : period_(period) {}

  std::int32_t sample(std::int32_t target) {
    if (count_ == 0) held_ = target;
    count_ = count_ + 1 == period_ ? 0 : count_ + 1;
    return held_;
  }
  void restart() { count_ = 0; }

 private:
  int period_;
  int count_ = 0;
  std::int32_t held_ = 0;
};

// Gives what it got so many calls ago; the first value until then.
class DelayLine {
 public:
  explicit DelayLine(int delay) : values_(static_cast<std::size_t>(delay) + 1) {}

  std::int32_t shift(std::int32_t value) {
    if (!filled_) std::ranges::fill(values_, value);
    filled_ = true;
    values_[newest_] = value;
    newest_ = newest_ + 1 == values_.size() ? 0 : newest_ + 1;
    return values_[newest_];
  }
  void restart() { filled_ = false; }

 private:
  std::vector<std::int32_t> values_;
  std::size_t newest_ = 0;
  bool filled_ = false;
};

// An error within it counts as none; a larger one in full, as in servos of hobby kind.
class DeadBand {
 public:
  explicit DeadBand(double band_rad) : band_units_(band_rad / kRadPerPositionUnit) {}

  std::int32_t target(std::int32_t target, std::int32_t position) const {
    return std::abs(static_cast<double>(target) - position) <= band_units_ ? position : target;
  }

 private:
  double band_units_;
};

}  // namespace koboshi::sim_board
