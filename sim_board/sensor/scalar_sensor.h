#pragma once

#include <cstdint>
#include <string_view>

#include "sim_board/random/random_stream.h"
#include "sim_board/robot/description.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/sensor/sampler.h"

namespace koboshi::sim {

// One slow quantity on its way to a microcontroller's register, as a supply's voltage behind its divider or
// the temperature of a winding: scale, offset, noise, range, resolution, held between samples. A sample is
//
//   lowest + resolution round((clamp((1 + scale) value + offset + noise) - lowest) / resolution).
class ScalarSensor {
 public:
  // `name` tells this sensor's random streams from all others'. Throws std::invalid_argument for a resolution
  // or sampling period that is not positive, and where highest is not above lowest.
  ScalarSensor(const ScalarSensorDescription& description, std::string_view name, const SensorErrors& errors);

  // What there is at `time_us`, and on a straight line since the last call. Takes the samples that fall due;
  // the first call takes one at once. Times increase.
  void step(double value, std::uint64_t time_us);
  // What the last sample reads, in the description's unit.
  double reading() const { return reading_; }

 private:
  double sample(double value);

  double noise_;
  double lowest_;
  double highest_;
  double resolution_;
  double gain_;
  double offset_;
  RandomStream random_;
  Sampler sampler_;
  double value_ = 0.0;
  std::uint64_t time_us_ = 0;
  double reading_ = 0.0;
  bool started_ = false;
};

}  // namespace koboshi::sim
