#include "sim_board/sensor/channel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace koboshi::sim_board {

Saturation::Saturation(double range) : range_(range) {
  if (!(range > 0.0)) throw std::invalid_argument("saturation: range must be greater than zero");
}

double Saturation::apply(double value) const { return std::clamp(value, -range_, range_); }

Quantiser::Quantiser(double resolution) : resolution_(resolution) {
  if (!(resolution > 0.0)) throw std::invalid_argument("quantiser: resolution must be greater than zero");
}

std::int16_t Quantiser::convert(double value) const {
  using Limits = std::numeric_limits<std::int16_t>;
  const double count = std::nearbyint(value / resolution_);
  return static_cast<std::int16_t>(std::clamp<double>(count, Limits::min(), Limits::max()));
}

Channel::Channel(const ChannelDescription& description, std::string_view name, const SensorErrors& errors)
    : filter_(description.bandwidth_Hz),
      gains_(description.scale_error * errors.scale, description.cross_axis * errors.scale, errors.seed,
             name),
      bias_(description.bias * errors.scale, errors.seed, std::string(name) + ".bias"),
      instability_(description.bias_instability * errors.scale, description.sample_period_s, errors.seed,
                   std::string(name) + ".bias_instability"),
      walk_(description.random_walk * errors.scale, description.sample_period_s, errors.seed,
            std::string(name) + ".random_walk"),
      noise_(description.noise_density * errors.scale, description.sample_period_s, errors.seed,
             std::string(name) + ".noise"),
      saturation_(description.range),
      quantiser_(description.resolution) {}

std::array<std::int16_t, 3> Channel::sample() {
  const Eigen::Vector3d value = gains_.value() * filter_.output() + bias_.value() + instability_.sample() +
                                walk_.sample() + noise_.sample();
  std::array<std::int16_t, 3> counts{};
  for (int axis = 0; axis < 3; ++axis) {
    counts[static_cast<std::size_t>(axis)] = quantiser_.convert(saturation_.apply(value[axis]));
  }
  return counts;
}

}  // namespace koboshi::sim_board
