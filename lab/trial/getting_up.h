#pragma once

#include <cstdint>
#include <optional>

#include "lab/trial/scenario_trial.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// Observes how a robot that lies comes to stand.
class GettingUp {
 public:
  // Observes from the first command to play a motion or to get up on.
  explicit GettingUp(const simulation::Scenario& scenario);

  // Call it once a tick. Returns true when the robot has stood still for half a second.
  bool observe(const simulation::GroundTruth& truth, std::uint64_t now_us);

  // Time from the command until the robot stood to the end, within 15 degrees of upright and turning by less
  // than 0.15 rad/s; nothing if it did not.
  std::optional<double> stood_s() const;
  // 0 for a robot on its head, 1 for one that stands upright: half of it comes from the trunk's tilt, half
  // from its height, as a share of the height at the joints' targets.
  double uprightness() const { return uprightness_; }

 private:
  std::uint64_t begin_us_;
  std::optional<std::uint64_t> stands_since_us_;
  double uprightness_ = 0.0;
};

struct GettingUpTrial : ScenarioTrial {
  std::optional<double> stood_s{};      // as GettingUp::stood_s
  std::optional<double> uprightness{};  // at the end
};

// Plays a scenario in which a robot gets up, in the world that a seed draws, until it stands.
[[nodiscard]] GettingUpTrial play_getting_up(const simulation::Scenario& scenario, std::uint64_t seed);

}  // namespace koboshi::lab
