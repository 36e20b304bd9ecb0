#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <string>

#include "sim_board/random/random_stream.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// Pushes against the trunk at random times and in random level directions.
struct PushBounds {
  double first_s = 0.0;     // from the start to the first push
  double shortest_s = 1.5;  // from one push to the next
  double longest_s = 3.0;
  double lowest_N_s = 0.0;  // impulse
  double highest_N_s = 0.1;
  double duration_s = 0.05;  // half a sine wave
};

inline constexpr double kTurn_rad = 2.0 * std::numbers::pi;  // a whole turn
inline constexpr double kPush_s = 0.1;                       // duration of a half-sine push in experiments

// Uniform from `low` on, below `high`.
[[nodiscard]] double between(sim_board::RandomStream& random, double low, double high);

[[nodiscard]] std::uint64_t to_us(double time_s);

// A push at the centre of mass of `link`, half a sine wave long.
[[nodiscard]] simulation::Push half_sine_push(const std::string& link, std::uint64_t at_us, double duration_s,
                                              const Eigen::Vector3d& impulse_W_N_s);

// Adds pushes against `link` from `from_us` to the scenario's end.
void add_pushes(simulation::Scenario& scenario, const std::string& link, std::uint64_t from_us,
                const PushBounds& bounds, std::uint64_t seed);

}  // namespace koboshi::lab
