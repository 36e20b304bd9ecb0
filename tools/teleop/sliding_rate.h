#pragma once

#include <array>
#include <cstddef>
#include <deque>

namespace koboshi::tools {

// The mean rate of change of running totals over a sliding window.
template <std::size_t kTotals>
class SlidingRate {
 public:
  using Totals = std::array<double, kTotals>;

  explicit SlidingRate(double window_s) : window_s_(window_s) {}

  // Samples come in the order of time.
  void add(double time_s, const Totals& totals) {
    samples_.push_back({time_s, totals});
    while (samples_.size() > 2 && samples_[1].time_s <= time_s - window_s_) samples_.pop_front();
  }
  // Zero before two samples of different times.
  Totals per_s() const {
    Totals rate{};
    if (samples_.empty()) return rate;
    const Sample& first = samples_.front();
    const Sample& last = samples_.back();
    if (!(last.time_s > first.time_s)) return rate;
    for (std::size_t i = 0; i < kTotals; ++i)
      rate[i] = (last.totals[i] - first.totals[i]) / (last.time_s - first.time_s);
    return rate;
  }

 private:
  struct Sample {
    double time_s;
    Totals totals;
  };

  double window_s_;
  std::deque<Sample> samples_;
};

}  // namespace koboshi::tools
