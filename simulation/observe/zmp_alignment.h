#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "simulation/observe/statistics.h"

namespace koboshi::simulation {

// The error of a measured ZMP against a planned one, aligned in time.
//
// The two differ in two ways that must not be mixed: in place, which is what a walk is judged by, and in
// time. The time is a constant of the chain from plan to measurement: interpolation of the targets, lag of
// the servos, and on the other side the ankle sensors' filters. While the ZMP crosses from foot to foot at
// 0.6 m/s, 25 ms of it alone make 15 mm. So the error is the root mean square at the one lag, of a walk, at
// which that is least; the lag is told beside it. This is the least-squares estimate of a constant delay, as
// by the peak of a cross-correlation.
class ZmpAlignment {
 public:
  struct Best {
    double rms_error_m;  // not a number without samples
    double lag_s;        // the measurement is so much later than the plan
  };

  // Adds a sample. `squared_error_m2(lag_s)` is the squared distance of what is measured now from what was
  // planned for `lag_s` earlier.
  template <typename SquaredError>
  void add(const SquaredError& squared_error_m2) {
    for (std::size_t i = 0; i < errors_.size(); ++i) errors_[i].add(squared_error_m2(lag_s(i)));
  }

  Best best() const {
    Best best{errors_[kMiddle].value(), lag_s(kMiddle)};
    if (std::isnan(best.rms_error_m)) best.lag_s = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < errors_.size(); ++i)
      if (errors_[i].value() < best.rms_error_m) best = {errors_[i].value(), lag_s(i)};
    return best;
  }

 private:
  // A step is 0.35 s long: beyond a quarter of it a lag would be another phase of the walk.
  static constexpr std::size_t kMiddle = 32;
  static constexpr double kStep_s = 0.0025;

  static double lag_s(std::size_t i) {
    return kStep_s * (static_cast<double>(i) - static_cast<double>(kMiddle));
  }

  std::array<RootMeanSquare, 2 * kMiddle + 1> errors_;
};

}  // namespace koboshi::simulation
