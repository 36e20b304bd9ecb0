#include "sim_board/sensor/noise.h"

#include <cmath>
#include <numbers>

namespace koboshi::sim_board {
namespace {

// Returns +1 or -1 for each of the last three bits. A table avoids a branch that would be mispredicted every
// other time and cost more than the rest of the function.
Eigen::Vector3d toss(std::uint64_t bits) {
  static constexpr std::array<double, 2> kSides{-1.0, 1.0};
  return {kSides[bits & 1u], kSides[bits >> 1 & 1u], kSides[bits >> 2 & 1u]};
}

}  // namespace

WhiteNoise::WhiteNoise(double density, double sample_period_s, std::uint64_t seed, std::string_view name)
    : sigma_(density * std::sqrt(0.5 / sample_period_s)), random_(seed, name) {}

Eigen::Vector3d WhiteNoise::sample() {
  // Separate statements: the order of evaluation of arguments is unspecified.
  const double x = random_.normal();
  const double y = random_.normal();
  const double z = random_.normal();
  return sigma_ * Eigen::Vector3d(x, y, z);
}

Bias::Bias(double largest, std::uint64_t seed, std::string_view name) {
  RandomStream random(seed, name);
  for (double& axis : value_) axis = random.within(largest);
}

BiasInstability::BiasInstability(double coefficient, double sample_period_s, std::uint64_t seed,
                                 std::string_view name)
    : sigma_(coefficient * std::sqrt(std::numbers::ln10 * std::numbers::inv_pi)), random_(seed, name) {
  double correlation_s = kShortest_s;
  for (Process& process : processes_) {
    process.decay = std::exp(-sample_period_s / correlation_s);
    process.kick = sigma_ * std::sqrt(1.0 - process.decay * process.decay);
    for (double& axis : process.state) axis = sigma_ * random_.normal();
    correlation_s *= 10.0;
  }
}

Eigen::Vector3d BiasInstability::sample() {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (sigma_ == 0.0) return sum;
  std::uint64_t bits = random_.bits();
  for (Process& process : processes_) {
    process.state = process.decay * process.state + process.kick * toss(bits);
    sum += process.state;
    bits >>= 3;
  }
  return sum;
}

RandomWalk::RandomWalk(double coefficient, double sample_period_s, std::uint64_t seed, std::string_view name)
    : kick_(coefficient * std::sqrt(sample_period_s)), random_(seed, name) {}

Eigen::Vector3d RandomWalk::sample() {
  if (kick_ == 0.0) return state_;
  state_ += kick_ * toss(random_.bits());
  return state_;
}

}  // namespace koboshi::sim_board
