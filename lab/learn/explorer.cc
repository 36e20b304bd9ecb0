#include "lab/learn/explorer.h"

#include <algorithm>
#include <utility>

#include "firmware/fixed/host/convert.h"

namespace koboshi::lab {

std::vector<double> network_inputs(const policy::Signals::Values& signals, const tools::PolicyMap& map) {
  std::vector<double> inputs;
  for (const tools::MappedInput& input : map.inputs) {
    double value = signals[input.signal] * input.unit;
    if (input.range) value = std::clamp(value, input.range->first, input.range->second);
    inputs.push_back(value * input.scale + input.offset);
  }
  return inputs;
}

Explorer::Explorer(const tools::PolicyMap& map, std::span<const double> deviations, std::size_t held_cycles,
                   const RewardWeights& reward, double walk_s, std::uint64_t seed)
    : map_(map),
      deviations_(deviations.begin(), deviations.end()),
      held_cycles_(held_cycles),
      reward_(reward),
      walk_s_(walk_s),
      random_(seed, "exploration"),
      noise_(deviations.size(), 0.0) {}

policy::Residual::Deviations Explorer::deviations() {
  if (cycles_to_draw_ == 0) {
    for (double& each : noise_) each = random_.normal();
    cycles_to_draw_ = held_cycles_;
  }
  --cycles_to_draw_;
  policy::Residual::Deviations deviations{};
  for (std::size_t i = 0; i < noise_.size(); ++i)
    deviations[i] = fixed::from_double<fixed::Angle>(deviations_[i] * noise_[i] * map_.outputs[i].scale_rad);
  return deviations;
}

void Explorer::cycle(const policy::Signals::Values& signals) {
  const bool is_new = cycles_to_draw_ + 1 == held_cycles_;
  if (!is_new) return;
  const std::vector<double> inputs = network_inputs(signals, map_);
  path_.inputs.insert(path_.inputs.end(), inputs.begin(), inputs.end());
  path_.noise.insert(path_.noise.end(), noise_.begin(), noise_.end());
  path_.rewards.push_back(0.0);
}

void Explorer::earned(const RewardTerms& terms) {
  if (!path_.rewards.empty()) path_.rewards.back() += reward_of(terms, reward_, walk_s_);
}

Path Explorer::finish(bool lost) {
  path_.lost = lost;
  if (lost && !path_.rewards.empty()) path_.rewards.back() -= reward_.survival;
  return std::move(path_);
}

}  // namespace koboshi::lab
