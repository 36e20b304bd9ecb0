#pragma once

#include <cstdint>
#include <string_view>

#include "sim_board/description/description.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/sensor/sampler.h"

namespace koboshi::sim_board {

// Sensor of one slow quantity, such as a supply voltage or the temperature of a winding, as read by a
// microcontroller. Models scale error, offset, noise, range and resolution, and holds each sample until the
// next:
//
//   sample = lowest + resolution round((clamp((1 + scale) value + offset + noise) - lowest) / resolution).
class ScalarSensor {
 public:
  // `name` identifies the random streams of this sensor. Throws std::invalid_argument unless resolution and
  // sampling period are positive and highest is above lowest.
  ScalarSensor(const ScalarSensorDescription& description, std::string_view name, const SensorErrors& errors);

  // Sets the value at `time_us` and takes the samples that have become due, with linear interpolation since
  // the previous call. The first call takes a sample at once. Times must increase. Returns whether it has
  // taken any.
  bool step(double value, std::uint64_t time_us) {
    const bool samples = !started_ || sampler_.due(time_us);
    if (samples) take_samples(value, time_us);
    value_ = value;
    time_us_ = time_us;
    return samples;
  }
  // Last sample, in the description's unit.
  double reading() const { return reading_; }

 private:
  void take_samples(double value, std::uint64_t time_us);
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

}  // namespace koboshi::sim_board
