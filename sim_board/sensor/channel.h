#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/robot/description.h"
#include "sim_board/sensor/converter.h"
#include "sim_board/sensor/low_pass.h"
#include "sim_board/sensor/noise.h"

namespace koboshi::sim {

// What makes a robot's sensors imperfect, and by how much.
struct SensorErrors {
  std::uint64_t seed = 1;
  double scale = 1.0;  // of noise and bias: 0 leaves bandwidth, range and resolution only
};

// Three axes of one quantity on their way from the world to counts:
// anti-alias filter, noise, bias, range, resolution. Units as in the description.
class Channel {
 public:
  // `name` tells this channel's random streams from all others'. Throws std::invalid_argument for a
  // bandwidth, range, resolution or sampling period that is not positive.
  Channel(const ChannelDescription& description, std::string_view name, const SensorErrors& errors);

  LowPass& filter() { return filter_; }
  // What a sample taken now reads.
  std::array<std::int16_t, 3> sample();

 private:
  LowPass filter_;
  WhiteNoise noise_;
  Bias bias_;
  Saturation saturation_;
  Quantiser quantiser_;
};

}  // namespace koboshi::sim
