#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace koboshi::sim_board {

// The speed of a shaft from its encoder: the difference of two positions kSamples loops apart, since one
// count of a 12-bit encoder in one loop of 1 ms would already be 1.5 rad/s.
class VelocityEstimate {
 public:
  static constexpr std::size_t kSamples = 8;

  // One loop of 1 ms. Before kSamples loops the shaft counts as having stood.
  void step(std::int32_t position_units) {
    if (!started_) positions_.fill(position_units);
    started_ = true;
    const std::int64_t difference = std::int64_t{position_units} - positions_[next_];
    positions_[next_] = position_units;
    next_ = (next_ + 1) % kSamples;
    units_per_s_ = static_cast<std::int32_t>(difference * (1'000 / static_cast<std::int64_t>(kSamples)));
  }
  std::int32_t units_per_s() const { return units_per_s_; }

 private:
  std::array<std::int32_t, kSamples> positions_{};
  std::size_t next_ = 0;
  bool started_ = false;
  std::int32_t units_per_s_ = 0;
};

}  // namespace koboshi::sim_board
