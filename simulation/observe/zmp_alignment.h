#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "simulation/observe/statistics.h"

namespace koboshi::simulation {

// Error of a measured ZMP relative to a planned one, after alignment in time.
//
// The two differ in place, which is the criterion of a walk, and in time. The delay is a constant of the
// chain from plan to measurement: interpolation of the targets, lag of the servos, and filters of the ankle
// sensors. While the ZMP crosses between the feet at 0.6 m/s, a delay of 25 ms alone causes 15 mm of error.
// The error is therefore the RMS at the one lag per walk that minimises it, and the lag is reported
// separately. This is the least-squares estimate of a constant delay, equivalent to the peak of a
// cross-correlation.
class ZmpAlignment {
 public:
  struct Best {
    double rms_error_m;  // NaN without samples
    double lag_s;        // delay of the measurement relative to the plan
  };

  // Adds a sample. `squared_error_m2(lag_s)` is the squared distance between the present measurement and the
  // plan `lag_s` earlier.
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
  // Maximum lag: a quarter of the 0.35 s of a step. A larger lag would align different phases of the walk.
  static constexpr std::size_t kMiddle = 32;
  static constexpr double kStep_s = 0.0025;

  static double lag_s(std::size_t i) {
    return kStep_s * (static_cast<double>(i) - static_cast<double>(kMiddle));
  }

  std::array<RootMeanSquare, 2 * kMiddle + 1> errors_;
};

}  // namespace koboshi::simulation
