#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace koboshi::lab {

// Where a search stands between two generations: all on which the later ones depend, beside its options.
struct SearchState {
  std::uint64_t generation = 0;  // how many have been played
  std::uint64_t steps = 0;       // of Adam
  std::vector<double> mean{};    // the parameters
  std::vector<double> first_moment{};
  std::vector<double> second_moment{};

  [[nodiscard]] static SearchState at(std::vector<double> start);
};

// Moves the parameters up the gradient by a step of Adam (D. Kingma, J. Ba, "Adam: A Method for Stochastic
// Optimization", 2015).
void ascend(SearchState& state, std::span<const double> gradient, double learning_rate);

}  // namespace koboshi::lab
