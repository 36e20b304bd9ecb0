#include "sim_board/sensor/scalar_sensor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace koboshi::sim_board {
namespace {

Sampler make_sampler(const ScalarSensorDescription& description, std::uint64_t seed, std::string_view name) {
  if (!(description.sample_period_s > 0.0)) {
    throw std::invalid_argument("scalar sensor: sampling period must be greater than zero");
  }
  return {static_cast<std::uint64_t>(std::llround(1e6 * description.sample_period_s)), {0, seed, name}};
}

}  // namespace

ScalarSensor::ScalarSensor(const ScalarSensorDescription& description, std::string_view name,
                           const SensorErrors& errors)
    : noise_(description.noise * errors.scale),
      lowest_(description.lowest),
      highest_(description.highest),
      resolution_(description.resolution),
      gain_(1.0 + RandomStream(errors.seed, std::string(name) + ".scale")
                      .within(description.scale_error * errors.scale)),
      offset_(
          RandomStream(errors.seed, std::string(name) + ".offset").within(description.offset * errors.scale)),
      random_(errors.seed, std::string(name) + ".noise"),
      sampler_(make_sampler(description, errors.seed, name)) {
  if (!(resolution_ > 0.0)) {
    throw std::invalid_argument("scalar sensor: resolution must be greater than zero");
  }
  if (!(highest_ > lowest_)) throw std::invalid_argument("scalar sensor: highest must be above lowest");
}

void ScalarSensor::take_samples(double value, std::uint64_t time_us) {
  if (!started_) {
    reading_ = sample(value);
    sampler_.start(time_us);
    started_ = true;
  }
  while (sampler_.due(time_us)) {
    const std::uint64_t instant_us = sampler_.take().actual_us;
    const double part = static_cast<double>(instant_us - time_us_) / static_cast<double>(time_us - time_us_);
    reading_ = sample(value_ + part * (value - value_));
  }
}

double ScalarSensor::sample(double value) {
  const double shown = std::clamp(gain_ * value + offset_ + noise_ * random_.normal(), lowest_, highest_);
  return lowest_ + resolution_ * std::nearbyint((shown - lowest_) / resolution_);
}

}  // namespace koboshi::sim_board
