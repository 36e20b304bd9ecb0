#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace koboshi::lab {

// An evolution strategy that follows an estimate of the gradient of the smoothed objective (T. Salimans et
// al., "Evolution Strategies as a Scalable Alternative to Reinforcement Learning", 2017): opposite pairs of
// candidates, ranks instead of scores, and steps by Adam (D. Kingma, J. Ba, 2015).

struct EvolutionOptions {
  std::size_t population = 32;  // even
  double noise = 0.05;          // standard deviation of the candidates about the mean
  double learning_rate = 0.02;
  double weight_decay = 0.0;
  std::uint64_t seed = 1;
};

// All that a later generation depends on, beside the options.
struct EvolutionState {
  std::uint64_t generation = 0;  // how many have been told
  std::vector<double> mean{};
  std::vector<double> first_moment{};   // of Adam
  std::vector<double> second_moment{};  // of Adam
};

class Evolution {
 public:
  Evolution(const EvolutionOptions& options, std::vector<double> start);
  // Continues from a state.
  Evolution(const EvolutionOptions& options, EvolutionState state);

  // The candidates of this generation: mean + noise, mean - noise, by pair. They depend on the state and the
  // seed alone.
  [[nodiscard]] std::vector<std::vector<double>> ask() const;
  // Moves the mean towards the candidates with high scores, one for each, in the order of ask(). Candidates
  // with equal scores share the mean of their ranks.
  void tell(std::span<const double> scores);

  [[nodiscard]] const EvolutionState& state() const { return state_; }

 private:
  [[nodiscard]] std::vector<std::vector<double>> noise() const;

  EvolutionOptions options_;
  EvolutionState state_;
};

// Ranks of the scores, scaled to -0.5 for the lowest to 0.5 for the highest.
[[nodiscard]] std::vector<double> centred_ranks(std::span<const double> scores);

}  // namespace koboshi::lab
