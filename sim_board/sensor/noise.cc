#include "sim_board/sensor/noise.h"

#include <cmath>

namespace koboshi::sim {

WhiteNoise::WhiteNoise(double density, double sample_period_s, std::uint64_t seed, std::string_view name)
    : sigma_(density * std::sqrt(0.5 / sample_period_s)), random_(seed, name) {}

Eigen::Vector3d WhiteNoise::sample() {
  // One statement a draw: the order in which arguments are evaluated is the compiler's choice.
  const double x = random_.normal();
  const double y = random_.normal();
  const double z = random_.normal();
  return sigma_ * Eigen::Vector3d(x, y, z);
}

Bias::Bias(double largest, std::uint64_t seed, std::string_view name) {
  RandomStream random(seed, name);
  for (double& axis : value_) axis = random.within(largest);
}

}  // namespace koboshi::sim
