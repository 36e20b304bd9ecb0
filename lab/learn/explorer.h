#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/learn/episode.h"
#include "lab/learn/learning_study.h"
#include "lab/policy_search/ppo.h"
#include "sim_board/random/random_stream.h"
#include "tools/policy/policy_map.h"

namespace koboshi::lab {

// The inputs of a network in a cycle: its signals, each within the range of training, scaled by the map.
[[nodiscard]] std::vector<double> network_inputs(const policy::Signals::Values& signals,
                                                 const tools::PolicyMap& map);

// Explores in an episode, by noise on the outputs, and records its path. The noise is held for some cycles,
// since servos follow no noise that changes in each of them; these cycles are one of the path.
class Explorer final : public CycleObserver {
 public:
  // `deviations`: of the noise, by output, as shares of the bounds. The map must outlive the explorer.
  Explorer(const tools::PolicyMap& map, std::span<const double> deviations, std::size_t held_cycles,
           const RewardWeights& reward, double walk_s, std::uint64_t seed);

  policy::Residual::Deviations deviations() override;
  void cycle(const policy::Signals::Values& signals) override;
  void earned(const RewardTerms& terms) override;

  // The path of the episode, after its end.
  [[nodiscard]] Path finish(bool lost);

 private:
  const tools::PolicyMap& map_;
  const std::vector<double> deviations_;
  const std::size_t held_cycles_;
  const RewardWeights reward_;
  const double walk_s_;
  sim_board::RandomStream random_;
  std::vector<double> noise_;       // of the present cycle
  std::size_t cycles_to_draw_ = 0;  // until other noise
  Path path_;
};

}  // namespace koboshi::lab
