#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/policy_search/search_state.h"

namespace koboshi::lab {

// An evolution strategy that follows an estimate of the gradient of the smoothed objective (T. Salimans et
// al., "Evolution Strategies as a Scalable Alternative to Reinforcement Learning", 2017): opposite pairs of
// candidates, ranks instead of scores, and steps by Adam.

struct EvolutionOptions {
  std::size_t population = 32;  // even
  double noise = 0.05;          // standard deviation of the candidates about the mean
  double learning_rate = 0.02;
  double weight_decay = 0.0;
  std::uint64_t seed = 1;
};

class Evolution {
 public:
  // Begins or continues.
  Evolution(const EvolutionOptions& options, SearchState state);

  // The candidates of this generation: mean + noise, mean - noise, by pair. They depend on the state and the
  // seed alone.
  [[nodiscard]] std::vector<std::vector<double>> ask() const;
  // Moves the mean towards the candidates with high scores, one for each, in the order of ask(). Candidates
  // with equal scores share the mean of their ranks.
  void tell(std::span<const double> scores);

  [[nodiscard]] const SearchState& state() const { return state_; }

 private:
  [[nodiscard]] std::vector<std::vector<double>> noise() const;

  EvolutionOptions options_;
  SearchState state_;
};

// Ranks of the scores, scaled to -0.5 for the lowest to 0.5 for the highest.
[[nodiscard]] std::vector<double> centred_ranks(std::span<const double> scores);

}  // namespace koboshi::lab
