#include "sim_board/sensor/channel.h"

#include <string>

namespace koboshi::sim {

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

}  // namespace koboshi::sim
