#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/assembly/simulation.h"

namespace koboshi::lab {

// Measures how hard the feet land: the peaks of the load that their sensors show to the firmware, within
// their own bandwidth, errors and rate, in the first kImpact_us of each landing. A landing begins with a load
// of a twelfth of the robot's weight after one of less than half of that, the thresholds of the firmware's
// ContactWatch. Robots whose feet measure no force have none.
class Landings {
 public:
  static constexpr std::uint64_t kImpact_us = 100'000;  // half a step of the default robot

  explicit Landings(const sim_board::RobotDescription& robot);

  // Call it after each millisecond of a walk.
  void observe(const simulation::Simulation& simulation);

  // Returns the share of landings' peaks, 0 to 1, as a multiple of the robot's weight; nothing before the
  // first landing ended.
  [[nodiscard]] std::optional<double> peak(double share) const;

 private:
  struct Sensor {
    bool cells = false;         // four of them, whose forces add up
    double resolution_N = 0.0;  // 0: measures no force
  };
  struct Foot {
    bool swings = false;
    std::optional<std::uint64_t> landed_us{};
    double peak_N = 0.0;
  };

  [[nodiscard]] static Sensor sensor(const std::optional<sim_board::AnkleSensorDescription>& description);
  [[nodiscard]] double load_N(const sim_board::SimBoard& board, std::size_t foot) const;

  std::array<Sensor, 2> sensors_;
  double weight_N_;
  std::array<Foot, 2> feet_{};
  std::vector<double> peaks_;  // multiples of the weight
};

}  // namespace koboshi::lab
