#include "lab/trial/pushes.h"

#include <algorithm>
#include <cmath>

namespace koboshi::lab {

double between(sim_board::RandomStream& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

std::uint64_t to_us(double time_s) { return static_cast<std::uint64_t>(std::llround(1e6 * time_s)); }

simulation::Push half_sine_push(const std::string& link, std::uint64_t at_us, double duration_s,
                                const Eigen::Vector3d& impulse_W_N_s) {
  // The impulse of half a sine wave is 2/pi of peak times duration.
  return {.at_us = at_us,
          .duration_us = to_us(duration_s),
          .link = {link, "a push of an experiment", 0},
          .shape = simulation::Push::Shape::kHalfSine,
          .force_W_N = std::numbers::pi / (2.0 * duration_s) * impulse_W_N_s,
          .p_L_m = std::nullopt};
}

void add_pushes(simulation::Scenario& scenario, const std::string& link, std::uint64_t from_us,
                const PushBounds& bounds, std::uint64_t seed) {
  sim_board::RandomStream random(seed, "pushes");
  std::uint64_t at_us = from_us + to_us(bounds.first_s);
  while (at_us < scenario.duration_us) {
    const double impulse_N_s = between(random, bounds.lowest_N_s, bounds.highest_N_s);
    const double direction_rad = between(random, 0.0, kTurn_rad);
    scenario.pushes.push_back(
        half_sine_push(link, at_us, bounds.duration_s,
                       impulse_N_s * Eigen::Vector3d(std::cos(direction_rad), std::sin(direction_rad), 0.0)));
    at_us += to_us(between(random, bounds.shortest_s, bounds.longest_s));
  }
  std::ranges::stable_sort(scenario.pushes, {}, &simulation::Push::at_us);
}

}  // namespace koboshi::lab
