#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/robot/description.h"
#include "sim_board/sensor/converter.h"
#include "sim_board/sensor/drift.h"
#include "sim_board/sensor/low_pass.h"
#include "sim_board/sensor/noise.h"
#include "sim_board/sensor/sensitivity.h"

namespace koboshi::sim {

// What makes a robot's sensors imperfect, and by how much.
struct SensorErrors {
  std::uint64_t seed = 1;
  double scale = 1.0;  // of all that is random: 0 leaves bandwidth, range, resolution, rate and delay only
};

// Three axes of one quantity on their way from the world to counts:
// anti-alias filter, scale and cross axis, bias and its drift, noise, range, resolution. Units as in the
// description. (Scale and cross axis belong to the sensing element, in front of the filter; as it is linear
// and alike for the three axes, to turn what comes out of it is the same and takes a product a sample only.)
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
  AxisGains gains_;
  Bias bias_;
  BiasInstability instability_;
  RandomWalk walk_;
  WhiteNoise noise_;
  Saturation saturation_;
  Quantiser quantiser_;
};

}  // namespace koboshi::sim
