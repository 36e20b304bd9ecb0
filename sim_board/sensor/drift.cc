#include "sim_board/sensor/drift.h"

#include <cmath>
#include <numbers>

namespace koboshi::sim {
namespace {

// Fair coins out of the bits of one draw.
class Coins {
 public:
  explicit Coins(std::uint64_t bits) : bits_(bits) {}
  // +1 or -1.
  double toss() {
    const double side = static_cast<double>(static_cast<int>(bits_ & 1u) * 2 - 1);
    bits_ >>= 1;
    return side;
  }

 private:
  std::uint64_t bits_;
};

}  // namespace

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
  Coins coins(random_.bits());
  for (Process& process : processes_) {
    for (double& axis : process.state) axis = process.decay * axis + process.kick * coins.toss();
    sum += process.state;
  }
  return sum;
}

RandomWalk::RandomWalk(double coefficient, double sample_period_s, std::uint64_t seed, std::string_view name)
    : kick_(coefficient * std::sqrt(sample_period_s)), random_(seed, name) {}

Eigen::Vector3d RandomWalk::sample() {
  if (kick_ == 0.0) return state_;
  Coins coins(random_.bits());
  for (double& axis : state_) axis += kick_ * coins.toss();
  return state_;
}

}  // namespace koboshi::sim
