#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/description/description.h"
#include "sim_board/sensor/low_pass.h"
#include "sim_board/sensor/noise.h"
#include "sim_board/sensor/sensitivity.h"

namespace koboshi::sim_board {

// Range of a sensing element: limits values to +-range.
class Saturation {
 public:
  // Throws std::invalid_argument unless range > 0.
  explicit Saturation(double range);
  double apply(double value) const;

 private:
  double range_;
};

// 16-bit analogue-to-digital converter: rounds to the nearest count, ties to even, and saturates at its ends.
class Quantiser {
 public:
  // `resolution` in unit / count. Throws std::invalid_argument unless it is positive.
  explicit Quantiser(double resolution);
  std::int16_t convert(double value) const;

 private:
  double resolution_;
};

// Converts three axes of one quantity to counts, in this order: anti-alias filter, scale factor and
// cross-axis sensitivity, bias and its drift, noise, range, resolution. Units as in the description. (Scale
// factor and cross-axis sensitivity belong to the sensing element, in front of the filter. The filter is
// linear and equal for all axes, so multiplying its output is equivalent and costs one product per sample.)
class Channel {
 public:
  // `name` identifies the random streams of this channel. Throws std::invalid_argument for a bandwidth,
  // range, resolution or sampling period that is not positive.
  Channel(const ChannelDescription& description, std::string_view name, const SensorErrors& errors);

  LowPass& filter() { return filter_; }
  // Takes a sample now.
  std::array<std::int16_t, 3> sample();

 private:
  LowPass filter_;
  AxisGains gains_;
  Bias bias_;
  BiasInstability instability_;
  RandomWalk walk_;
  WhiteNoise noise_;
  Saturation saturation_;
  Quantiser quantiser_;
};

}  // namespace koboshi::sim_board
