#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/policy_search/mirrored_network.h"
#include "lab/policy_search/search_state.h"

namespace koboshi::lab {

// Proximal policy optimisation (J. Schulman et al., "Proximal Policy Optimization Algorithms", 2017) with
// advantages by J. Schulman et al., "High-Dimensional Continuous Control Using Generalized Advantage
// Estimation", 2016.

struct PpoOptions {
  double deviation = 0.2;         // first standard deviation of the exploration, as a share of the bounds
  double learning_rate = 0.001;   // step size of Adam
  double discount = 0.97;         // of a reward, by step
  double trace = 0.95;            // lambda of the advantages
  double clip = 0.2;              // largest gain of a ratio of probabilities that pays
  std::size_t epochs = 5;         // passes over the steps of a generation, at most
  std::size_t minibatch = 1'024;  // steps
  std::vector<std::size_t> critic{32,
                                  32};  // neurons of the hidden layers of the critic, which is not uploaded
  std::uint64_t seed = 1;
};

// The record of an exploring episode. A step lasts one or more control cycles. Its action is the network's
// output plus noise times the deviation of this output.
struct Path {
  std::vector<double> inputs;   // of the network, for each step
  std::vector<double> noise;    // standard normal, of the network's outputs, for each step
  std::vector<double> rewards;  // for each step
  // Ended by a loss, after which there are no rewards. The rewards after other ends are the critic's.
  bool lost = false;

  [[nodiscard]] std::size_t steps() const { return rewards.size(); }
  // Steps that have an advantage.
  [[nodiscard]] std::size_t learnable_steps() const { return steps() - (lost || steps() == 0 ? 0 : 1); }
};

// The outcome of a generation.
struct PpoProgress {
  double divergence = 0.0;   // mean Kullback-Leibler divergence of the new policy from the old one
  double clipped = 0.0;      // share of the steps whose ratio has left the clip, in the last epoch
  double value_error = 0.0;  // root mean square error of the critic, before
  std::size_t epochs = 0;    // that were played
};

class Ppo {
 public:
  // The actor is the policy's network; `outputs` are the mirror images of its outputs.
  Ppo(const PpoOptions& options, MirroredNetwork actor, std::size_t inputs, MirrorImage outputs);

  // The first parameters: of the actor, the logarithms of the deviations, those of the critic.
  [[nodiscard]] std::vector<double> start() const;
  // Standard deviations of the exploration, by output.
  [[nodiscard]] std::vector<double> deviations(const SearchState& state) const;
  // Plays the epochs of a generation. Requires a step at least.
  PpoProgress improve(SearchState& state, const std::vector<Path>& paths) const;

 private:
  struct Samples;
  struct Gradient;

  [[nodiscard]] std::span<const double> part(const SearchState& state, std::size_t begin,
                                             std::size_t size) const {
    return std::span(state.mean).subspan(begin, size);
  }
  [[nodiscard]] tools::Mlp actor(const SearchState& state) const;
  [[nodiscard]] tools::Mlp critic(const SearchState& state) const;
  [[nodiscard]] Samples samples(const SearchState& state, const std::vector<Path>& paths) const;
  [[nodiscard]] Gradient gradient(const SearchState& state, const Samples& samples,
                                  std::span<const Eigen::Index> chosen) const;

  PpoOptions options_;
  MirroredNetwork actor_;
  MirrorImage outputs_;
  MirroredNetwork critic_;
};

// Advantages of the steps of a path, by the critic's values of these steps. The last step of a path that
// was not lost has none: its value stands for all that would have followed.
[[nodiscard]] std::vector<double> advantages(const Path& path, std::span<const double> values,
                                             double discount, double trace);

}  // namespace koboshi::lab
