#include "lab/policy_search/search_state.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace koboshi::lab {
namespace {

// Decay rates and guard against a division by zero: the values of the paper.
constexpr double kFirstDecay = 0.9;
constexpr double kSecondDecay = 0.999;
constexpr double kAdamGuard = 1e-8;

}  // namespace

SearchState SearchState::at(std::vector<double> start) {
  SearchState state{.mean = std::move(start)};
  state.first_moment.assign(state.mean.size(), 0.0);
  state.second_moment.assign(state.mean.size(), 0.0);
  return state;
}

void ascend(SearchState& state, std::span<const double> gradient, double learning_rate) {
  if (gradient.size() != state.mean.size()) throw std::logic_error("a gradient of another size");
  ++state.steps;
  const auto step = static_cast<double>(state.steps);
  const double first_scale = 1.0 / (1.0 - std::pow(kFirstDecay, step));
  const double second_scale = 1.0 / (1.0 - std::pow(kSecondDecay, step));
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    double& first = state.first_moment[i];
    double& second = state.second_moment[i];
    first = kFirstDecay * first + (1.0 - kFirstDecay) * gradient[i];
    second = kSecondDecay * second + (1.0 - kSecondDecay) * gradient[i] * gradient[i];
    state.mean[i] += learning_rate * first * first_scale / (std::sqrt(second * second_scale) + kAdamGuard);
  }
}

}  // namespace koboshi::lab
