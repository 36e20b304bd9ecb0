#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace koboshi::sim {

// The range of a sensing element: beyond +-range it shows its end.
class Saturation {
 public:
  explicit Saturation(double range) : range_(range) {
    if (!(range > 0.0)) throw std::invalid_argument("saturation: range must be greater than zero");
  }
  double apply(double value) const { return std::clamp(value, -range_, range_); }

 private:
  double range_;
};

// An analogue-to-digital converter of 16 bits: the nearest count, ties to even; its ends saturate.
class Quantiser {
 public:
  // `resolution` in unit / count.
  explicit Quantiser(double resolution) : resolution_(resolution) {
    if (!(resolution > 0.0)) throw std::invalid_argument("quantiser: resolution must be greater than zero");
  }
  std::int16_t convert(double value) const {
    using Limits = std::numeric_limits<std::int16_t>;
    const double count = std::nearbyint(value / resolution_);
    return static_cast<std::int16_t>(std::clamp<double>(count, Limits::min(), Limits::max()));
  }

 private:
  double resolution_;
};

}  // namespace koboshi::sim
